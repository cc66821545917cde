// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/slabs/segment_slabs.h"

#include <string>
#include <utility>

#include "vdb_madf/base/errors.h"
#include "vdb_madf/grids/grid_metadata.h"
#include "vdb_madf/segmentation/detail/prepare.h"
#include "vdb_madf/segmentation/graph_metadata.h"
#include "vdb_madf/segmentation/segmentation_metadata.h"
#include "vdb_madf/slabs/steps/slab_flow.h"
#include "vdb_madf/slabs/steps/slab_grains.h"
#include "vdb_madf/slabs/steps/slab_labels.h"
#include "vdb_madf/slabs/steps/slab_options.h"

namespace vdb_madf {

namespace {

/// The manifolds of a slab, with its part of the graph.
Int32Grid::Ptr manifoldGrid(const detail::SlabWork& work, size_t slab,
                            const detail::SlabBody& body) {
  detail::SlabPart part;
  VoxelArray<uint32_t> manifold;
  if (body.index.voxelCount() > 0) manifold = work.store.read(detail::kFlow, slab);
  if (work.store.has(detail::kGraphPart, slab)) part = work.store.read(detail::kGraphPart, slab);
  for (size_t i = 0; i < manifold.size(); ++i)
    manifold[i] = part.number[part.nodeOf[(manifold[i] & ~Flow::kOwnCell) - 1]];
  const Int32Grid::Ptr grid = detail::slabGrid(work, slab, body, std::move(manifold), "manifold");
  part.graph.weights = work.facts.weights;
  setGraphPart(*grid, std::move(part));
  return grid;
}

/// Says of a grid how it was made.
void describe(const detail::SlabWork& work, const SlabSegmentation& result, Int32Grid& grid) {
  copyProvenance(*work.plan.object.about, grid);
  if (result.domain) setDomain(grid, *result.domain);
  describeSegmentation(grid, work.options, result);
}

}  // namespace

SlabSegmentation segmentSlabs(const SlabObject& object, const SegmentOptions& options,
                              Scratch& scratch, Team& team, const PutSlab& put,
                              Interrupter* interrupter) {
  detail::checkSlabOptions(object, options);
  SlabSegmentation result;
  if (object.slabCount() == 0) return result;
  detail::SlabWork work(object, options, scratch, team, interrupter);
  detail::flowInSlabs(work, result);
  work.steps.beginStage("merge");
  std::vector<Coord> representatives;
  if (result.counts.objectVoxels > 0)
    representatives =
        detail::mergeParts(work, [&](size_t s) { return work.store.read(detail::kGraphPart, s); });
  result.counts.grains = int64_t(representatives.size());
  if (work.plan.isRoot()) result.grainVoxels.assign(representatives.size(), 0);
  result.counts = work.store.broadcast(result.counts);
  detail::labelSlabs(work, std::move(representatives), result,
                     [&](size_t slab, const detail::SlabBody& body, VoxelArray<uint32_t> labels) {
                       SlabGrids grids;
                       grids.grain = detail::slabGrid(work, slab, body, std::move(labels), "grain");
                       if (options.keepManifold) grids.manifold = manifoldGrid(work, slab, body);
                       for (const Int32Grid::Ptr& grid : {grids.grain, grids.manifold})
                         if (grid) describe(work, result, *grid);
                       put(slab, grids);
                     });
  work.steps.endStages(result);
  return result;
}

SlabSegmentation segmentSlabs(const SlabObject& object, const SegmentOptions& options,
                              Scratch& scratch, const PutSlab& put, Interrupter* interrupter) {
  Team alone;
  return segmentSlabs(object, options, scratch, alone, put, interrupter);
}

void detail::checkSlabOptions(const SlabObject& object, const SegmentOptions& options) {
  checkSegmentOptions(options);
  if (options.keepDistance || options.keepPower || options.keepBalls)
    throw InvalidInput("slabs give labels and manifolds alone: keep no other grids");
  if (options.autoStrictness)
    throw InvalidInput(
        "the strictness of largest stability is that of a whole graph: segment with keepManifold, "
        "and remerge at it");
  if (options.maxMemory != 0)
    throw InvalidInput("the memory of slabs follows from their cuts: leave maxMemory 0");
  const std::vector<int>& cuts = object.cuts;
  for (size_t i = 0; i < cuts.size(); ++i)
    if ((cuts[i] & 7) != 0 || (i > 0 && cuts[i] <= cuts[i - 1]))
      throw InvalidInput("slabs are cut at ascending multiples of 8 along z");
  for (size_t s = 1; s + 1 < object.slabCount(); ++s)
    if (cuts[s + 1] - cuts[s] < options.tidy)
      throw InvalidInput("interfaces are smoothed in " + std::to_string(options.tidy) +
                         " rounds: take slabs at least as many voxels high");
}

bool isSlabPut(const Scratch& scratch, size_t slab) {
  return scratch.has(detail::kPut.of(slab));
}

}  // namespace vdb_madf
