// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/slabs/cuts/slab_terminals.h"

#include <algorithm>

#include "vdb_madf/leaves/detail/leaf_mask.h"
#include "vdb_madf/method/detail/reduce_edges.h"
#include "vdb_madf/slabs/cuts/face_voxels.h"

namespace vdb_madf::detail {

namespace {

using Edge = ManifoldGraph::Edge;
using FaceVoxel = SlabTerminals::FaceVoxel;

std::vector<FaceVoxel> faceVoxels(const LeafIndex& index, const Flow& flow,
                                  const VoxelArray<int32_t>& power, int leafZ, uint32_t layer) {
  std::vector<FaceVoxel> face;
  for (uint32_t leaf = 0; leaf < index.leafCount(); ++leaf) {
    if (index.origin(leaf).z() != leafZ) continue;
    forEachBit(layersAlongZ(index.mask(leaf))[layer], [&](int row) {
      const VoxelId id = voxelId(leaf, size_t(row) * 8 + layer);
      const size_t rank = index.rank(id);
      const Coord p = index.coord(id);
      face.push_back({p.x(), p.y(), flow.manifold[rank], power[rank]});
    });
  }
  return face;
}

}  // namespace

std::vector<Edge> SlabTerminals::contacts(const std::vector<FaceVoxel>& below,
                                          const std::vector<FaceVoxel>& above) {
  std::vector<Edge> edges;
  forEachFacing(below, above, [&](const FaceVoxel& a, const FaceVoxel& b) {
    edges.push_back({(a.terminal & ~Flow::kOwnCell) - 1, (b.terminal & ~Flow::kOwnCell) - 1, 1,
                     -std::max(a.power, b.power), (a.terminal & b.terminal & Flow::kOwnCell) != 0});
  });
  reduceEdges(edges);
  return edges;
}

SlabTerminals slabTerminals(const LeafIndex& index, const Flow& flow,
                            const VoxelArray<int32_t>& power, const VoxelSet& balls,
                            const std::vector<VoxelId>& cavities, int begin, int end,
                            Interrupter* interrupter) {
  ManifoldGraph graph = manifoldGraph(index, flow, power, interrupter);
  SlabTerminals result;
  result.points = std::move(graph.nodes);
  result.edges = std::move(graph.edges);
  for (const VoxelId id : cavities)
    result.points[(flow.manifold[index.rank(id)] & ~Flow::kOwnCell) - 1].leaveToCavity();
  for (size_t word = 0; word < index.leafCount() * 8; ++word)
    result.balls += countBits(balls.word(word));
  result.lowest = faceVoxels(index, flow, power, begin, 0);
  result.highest = faceVoxels(index, flow, power, end - 8, 7);
  return result;
}

}  // namespace vdb_madf::detail
