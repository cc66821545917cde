// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/slabs/steps/slab_remerge.h"

#include <map>
#include <numeric>
#include <utility>

#include "vdb_madf/base/errors.h"
#include "vdb_madf/grids/grid_metadata.h"
#include "vdb_madf/segmentation/detail/manifold_labels.h"
#include "vdb_madf/segmentation/graph_metadata.h"
#include "vdb_madf/slabs/cuts/part_check.h"
#include "vdb_madf/slabs/steps/slab_grains.h"

namespace vdb_madf::detail {

/// What of the part of a slab is known to the whole.
struct PartFacts {
  int64_t voxels;
  uint32_t criticalPoints;  ///< that lie in it
};

namespace {

/// The part of a slab as it was stored, with each node its own terminal.
SlabPart requiredPart(const Int32Grid& manifold) {
  auto stored = storedGraphPart(manifold);
  if (!stored)
    throw InvalidInput(
        "grid '" + manifold.getName() + "' carries no part of a graph of manifolds: segment again",
        Hint::manifolds);
  SlabPart part;
  static_cast<GraphPart&>(part) = std::move(*stored);
  part.nodeOf.resize(part.number.size());
  std::iota(part.nodeOf.begin(), part.nodeOf.end(), 0);
  part.startsBelow.assign(part.number.size(), 0);  // slabs are merged from the lowest on
  return part;
}

}  // namespace

SlabObject manifoldObject(const LabelSlabs& manifolds, const Scratch& scratch) {
  SlabObject object;
  object.cuts = manifolds.cuts;
  object.leaves = [&scratch](size_t slab) { return storedObject(scratch, slab); };
  return object;
}

SlabRemerge::SlabRemerge(const LabelSlabs& manifolds, SlabWork& work)
    : manifolds_(manifolds), work_(work) {
  work_.facts.weights = storedWeights(*manifolds.about);
  work_.facts.domain = storedDomain(*manifolds.about);
}

void SlabRemerge::read() {
  work_.steps.beginStage("read");
  work_.steps.forEachSlab(Step::read, [&](size_t s) { take(s); });
}

void SlabRemerge::merge(SlabSegmentation& result, const PutLabels& put) {
  work_.steps.beginStage("merge");
  uint32_t criticalPoints = 0;
  for (size_t s = 0; s < work_.plan.slabCount(); ++s) {
    const auto known = work_.store.read(kPartFacts, s).at(0);
    result.counts.objectVoxels += known.voxels;
    criticalPoints += known.criticalPoints;
  }
  PartCheck check(criticalPoints);
  for (size_t s = 0; s < work_.plan.slabCount(); ++s) check.add(work_.store.read(kGraphPart, s));
  check.finish();
  std::vector<Coord> representatives =
      mergeParts(work_, [&](size_t s) { return work_.store.read(kGraphPart, s); });
  result.counts.grains = int64_t(representatives.size());
  result.grainVoxels.assign(representatives.size(), 0);
  labelSlabs(work_, std::move(representatives), result, put);
}

/// Reads the manifolds of a slab: leaves of its object what steps of a segmentation do, with the
/// nodes of its part as terminals.
void SlabRemerge::take(size_t s) {
  const Int32Grid::Ptr manifold = manifolds_.read(s, work_.interrupter);
  const SlabPart part = requiredPart(*manifold);
  SlabBody body;
  body.index = topologyOf(*manifold);
  const LeafIndex& index = body.index;
  VoxelArray<uint32_t> terminal =
      nodesOf(*manifold, index, part.graph, part.number, work_.interrupter);
  for (size_t i = 0; i < terminal.size(); ++i) ++terminal[i];

  Leaves leaves;
  for (size_t leaf = 0; leaf < index.leafCount(); ++leaf)
    leaves.push_back({index.origin(leaf), index.mask(leaf)});
  work_.store.write(kObject, s, leaves);
  work_.store.write(kCavities, s, Leaves());
  sendHoles(s, index, part.graph);
  work_.store.write(kFlow, s, terminal);
  writeRims(work_, s, body, std::move(terminal));
  work_.store.write(kGraphPart, s, part);
}

/// The critical points in a slab that are no voxels of the object: they lie in cavities.
void SlabRemerge::sendHoles(size_t s, const LeafIndex& index, const ManifoldGraph& graph) {
  PartFacts facts{index.voxelCount(), 0};
  std::map<Coord, LeafIndex::Mask> holes;
  for (const CriticalPoint& node : graph.nodes) {
    const Coord& p = node.position;
    if (p.z() < work_.plan.begin(s) || p.z() >= work_.plan.end(s)) continue;
    ++facts.criticalPoints;
    if (index.findVoxel(p)) continue;
    const Coord origin(p.x() & ~7, p.y() & ~7, p.z() & ~7);
    holes[origin][size_t(p.x() & 7)] |= uint64_t(1) << ((p.y() & 7) * 8 + (p.z() & 7));
  }
  Leaves leaves;
  for (const auto& [origin, mask] : holes) leaves.push_back({origin, mask});
  work_.store.send(kHoles, s, kRoot, leaves);
  work_.store.write(kPartFacts, s, {facts});
}

}  // namespace vdb_madf::detail
