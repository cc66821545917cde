// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/slabs/segment_slabs.h"

#include <string>
#include <utility>

#include "vdb_madf/base/errors.h"
#include "vdb_madf/grids/grid_metadata.h"
#include "vdb_madf/method/detail/segment_options.h"
#include "vdb_madf/slabs/detail/slab_flow.h"
#include "vdb_madf/slabs/detail/slab_labels.h"

namespace vdb_madf {

namespace {

void checkSlabOptions(const SlabObject& object, const SegmentOptions& options) {
  detail::checkSegmentOptions(options);
  if (options.keepDistance || options.keepPower || options.keepManifold || options.keepBalls)
    throw InvalidInput("slabs give labels alone: keep no other grids");
  const std::vector<int>& cuts = object.cuts;
  for (size_t i = 0; i < cuts.size(); ++i)
    if ((cuts[i] & 7) != 0 || (i > 0 && cuts[i] <= cuts[i - 1]))
      throw InvalidInput("slabs are cut at ascending multiples of 8 along z");
  for (size_t s = 1; s + 1 < object.slabCount(); ++s)
    if (cuts[s + 1] - cuts[s] < options.tidy)
      throw InvalidInput("interfaces are smoothed in " + std::to_string(options.tidy) +
                         " rounds: take slabs at least as many voxels high");
}

}  // namespace

SlabSegmentation segmentSlabs(const SlabObject& object, const SegmentOptions& options,
                              Scratch& scratch, Ranks& ranks, const PutSlabLabels& put,
                              Interrupter* interrupter) {
  checkSlabOptions(object, options);
  SlabSegmentation result;
  if (object.slabCount() == 0) return result;
  result.domain = options.domain ? options.domain : storedDomain(*object.about);
  detail::SlabWork work(object, options, scratch, ranks, interrupter);
  work.domain = result.domain;
  detail::SlabGraph graph = detail::flowInSlabs(work, result);
  work.beginStage("merge");
  std::vector<Coord> representatives;
  if (work.isRoot()) {
    result.counts.criticalPoints = graph.criticalPoints();
    representatives = detail::mergeSlabs(work, std::move(graph));
    result.counts.grains = int64_t(representatives.size());
    result.grainVoxels.assign(size_t(result.counts.grains), 0);
  }
  work.exchange();
  detail::ByteWriter counts;
  counts.add(result.counts);
  result.counts = detail::ByteReader(work.broadcast(counts)).value<SegmentCounts>();
  detail::labelSlabs(work, std::move(representatives), result, put);
  work.endStages(result);
  return result;
}

SlabSegmentation segmentSlabs(const SlabObject& object, const SegmentOptions& options,
                              Scratch& scratch, const PutSlabLabels& put,
                              Interrupter* interrupter) {
  Ranks alone;
  return segmentSlabs(object, options, scratch, alone, put, interrupter);
}

bool isSlabPut(const Scratch& scratch, size_t slab) {
  return scratch.has(detail::SlabWork::name("put", slab));
}

}  // namespace vdb_madf
