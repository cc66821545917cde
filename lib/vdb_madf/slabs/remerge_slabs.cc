// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/slabs/remerge_slabs.h"

#include <algorithm>
#include <map>
#include <numeric>
#include <string>
#include <utility>

#include "vdb_madf/base/errors.h"
#include "vdb_madf/method/detail/manifold_labels.h"
#include "vdb_madf/method/graph_metadata.h"
#include "vdb_madf/method/segmentation_metadata.h"
#include "vdb_madf/slabs/detail/object_pieces.h"
#include "vdb_madf/slabs/detail/part_check.h"
#include "vdb_madf/slabs/detail/slab_labels.h"
#include "vdb_madf/slabs/detail/slab_options.h"

namespace vdb_madf {

namespace {

using detail::SlabWork;
using Leaves = std::vector<LeafIndex::LeafVoxels>;

/// The part of a slab as it was stored, with each node its own terminal.
detail::SlabGraph::Part requiredPart(const Int32Grid& manifold) {
  auto stored = storedGraphPart(manifold);
  if (!stored)
    throw InvalidInput(
        "grid '" + manifold.getName() + "' carries no part of a graph of manifolds: segment again",
        Hint::manifolds);
  detail::SlabGraph::Part part;
  static_cast<GraphPart&>(part) = std::move(*stored);
  part.nodeOf.resize(part.number.size());
  std::iota(part.nodeOf.begin(), part.nodeOf.end(), 0);
  return part;
}

/// What of a slab is known to the whole.
struct Known {
  int64_t voxels;
  uint32_t criticalPoints;  ///< that lie in it
};

class SlabRemerge {
 public:
  SlabRemerge(const LabelSlabs& manifolds, SlabWork& work) : manifolds_(manifolds), work_(work) {}

  std::vector<int64_t> run(const PutGrain& put) {
    work_.beginStage("read");
    work_.forEachSlab([&](size_t s) { take(s); });
    Known all{0, 0};
    for (size_t s = 0; s < work_.slabCount(); ++s) {
      const auto known = work_.readVector<Known>("known", s).at(0);
      all.voxels += known.voxels;
      all.criticalPoints += known.criticalPoints;
    }
    work_.beginStage("merge");
    detail::PartCheck check(all.criticalPoints);
    std::vector<Coord> representatives = mergeParts(work_, work_.slabCount(), [&](size_t s) {
      detail::SlabGraph::Part part = detail::readPart(work_.read("part", s));
      check.add(part);
      return part;
    });
    check.finish();
    SlabSegmentation result;
    result.counts.objectVoxels = all.voxels;
    result.counts.grains = int64_t(representatives.size());
    result.grainVoxels.assign(representatives.size(), 0);
    detail::labelSlabs(work_, std::move(representatives), result,
                       [&](size_t slab, const detail::SlabBody&, const Int32Grid::Ptr& grain) {
                         describe(result.counts.grains, *grain);
                         put(slab, grain);
                       });
    return std::move(result.grainVoxels);
  }

 private:
  /// Reads the manifolds of a slab: leaves of its object what steps of a segmentation do, with the nodes
  /// of its part as terminals.
  void take(size_t s) {
    const Int32Grid::Ptr manifold = manifolds_.read(s, work_.interrupter);
    const detail::SlabGraph::Part part = requiredPart(*manifold);
    detail::SlabBody body;
    body.index = detail::topologyOf(*manifold);
    const LeafIndex& index = body.index;
    VoxelArray<uint32_t> terminal =
        detail::nodesOf(*manifold, index, part.graph, part.number, work_.interrupter);
    for (size_t i = 0; i < terminal.size(); ++i) ++terminal[i];

    Leaves leaves;
    for (size_t leaf = 0; leaf < index.leafCount(); ++leaf)
      leaves.push_back({index.origin(leaf), index.mask(leaf)});
    detail::writeLeaves(work_.scratch, detail::objectName(s), leaves);
    work_.writeVector("cavities", s, Leaves());
    sendHoles(s, index, part.graph);
    detail::ByteWriter flow, graph;
    flow.add(terminal);
    work_.write("flow", s, flow);
    detail::writeRims(work_, s, body, std::move(terminal));
    detail::addPart(part, graph);
    work_.write("part", s, graph);
  }

  /// The critical points in a slab that are no voxels of the object: they lie in cavities.
  void sendHoles(size_t s, const LeafIndex& index, const ManifoldGraph& graph) {
    Known known{index.voxelCount(), 0};
    std::map<Coord, LeafIndex::Mask> holes;
    for (const CriticalPoint& node : graph.nodes) {
      const Coord& p = node.position;
      if (p.z() < work_.begin(s) || p.z() >= work_.end(s)) continue;
      ++known.criticalPoints;
      if (index.findVoxel(p)) continue;
      const Coord origin(p.x() & ~7, p.y() & ~7, p.z() & ~7);
      holes[origin][size_t(p.x() & 7)] |= uint64_t(1) << ((p.y() & 7) * 8 + (p.z() & 7));
    }
    Leaves leaves;
    for (const auto& [origin, mask] : holes) leaves.push_back({origin, mask});
    work_.sendVector("holes", s, SlabWork::kRoot, leaves);
    work_.writeVector("known", s, std::vector<Known>{known});
  }

  void describe(int64_t grains, Int32Grid& grain) const {
    const Int32Grid& about = *manifolds_.about;
    for (auto meta = about.beginMeta(); meta != about.endMeta(); ++meta)
      if (meta->first != openvdb::GridBase::META_GRID_NAME)
        grain.insertMeta(meta->first, *meta->second);
    grain.setTransform(about.transform().copy());
    removeGraph(grain);
    describeMerging(grain, work_.options.merge, work_.options.tidy, grains);
  }

  const LabelSlabs& manifolds_;
  SlabWork& work_;
};

}  // namespace

std::vector<int64_t> remergeSlabs(const LabelSlabs& manifolds, const MergeOptions& options,
                                  int tidyRounds, Scratch& scratch, const PutGrain& put,
                                  Interrupter* interrupter) {
  SegmentOptions how;
  how.merge = options;
  how.tidy = tidyRounds;
  SlabObject object;
  object.cuts = manifolds.cuts;
  object.leaves = [&scratch](size_t slab) {
    return detail::readLeaves(scratch, detail::objectName(slab));
  };
  detail::checkSlabOptions(object, how);
  if (object.slabCount() == 0) return {};
  Ranks alone;
  SlabWork work(object, how, scratch, alone, interrupter);
  work.weights = storedWeights(*manifolds.about);
  return SlabRemerge(manifolds, work).run(put);
}

}  // namespace vdb_madf
