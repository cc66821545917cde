// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/method/manifold_graph.h"

#include <algorithm>
#include <mutex>

#include "vdb_madf/base/detail/parallel.h"
#include "vdb_madf/base/detail/simd.h"
#include "vdb_madf/leaves/detail/leaf_values.h"
#include "vdb_madf/leaves/detail/voxels.h"
#include "vdb_madf/method/detail/reduce_edges.h"
#include "vdb_madf/method/flow.h"

namespace vdb_madf {

namespace {

using Edge = ManifoldGraph::Edge;

bool pairLess(const Edge& a, const Edge& b) {
  return a.first != b.first ? a.first < b.first : a.second < b.second;
}
bool samePair(const Edge& a, const Edge& b) {
  return a.first == b.first && a.second == b.second;
}

/// Adds what is known of an edge; sums and maxima, so the order does not matter.
void accumulate(Edge& edge, const Edge& part) {
  edge.contactFaces += part.contactFaces;
  edge.saddleHeight = std::max(edge.saddleHeight, part.saddleHeight);
  edge.cellsTouch |= part.cellsTouch;
}

/// Edges met by one thread in a few leaves: a small open-addressing table, one entry per pair.
class EdgeTable {
 public:
  void clear() {
    edges_.clear();
    slots_.assign(slots_.empty() ? 256 : slots_.size(), kEmpty);
  }

  void add(const Edge& part) {
    if (last_ < edges_.size() && samePair(edges_[last_], part)) {
      accumulate(edges_[last_], part);
      return;
    }
    size_t slot = hash(part) & (slots_.size() - 1);
    while (slots_[slot] != kEmpty && !samePair(edges_[slots_[slot]], part))
      slot = (slot + 1) & (slots_.size() - 1);
    if (slots_[slot] == kEmpty) {
      slots_[slot] = last_ = uint32_t(edges_.size());
      edges_.push_back(part);
      if (edges_.size() * 2 > slots_.size()) grow();
    } else {
      last_ = slots_[slot];
      accumulate(edges_[last_], part);
    }
  }

  const std::vector<Edge>& edges() const { return edges_; }

 private:
  static constexpr uint32_t kEmpty = ~0u;

  static size_t hash(const Edge& edge) {
    const uint64_t key = uint64_t(edge.first) << 32 | edge.second;
    return size_t(key * 0x9e3779b97f4a7c15ull >> 32);  // Fibonacci hashing
  }

  void grow() {
    slots_.assign(slots_.size() * 2, kEmpty);
    for (uint32_t i = 0; i < edges_.size(); ++i) {
      size_t slot = hash(edges_[i]) & (slots_.size() - 1);
      while (slots_[slot] != kEmpty) slot = (slot + 1) & (slots_.size() - 1);
      slots_[slot] = i;
    }
  }

  std::vector<Edge> edges_;
  std::vector<uint32_t> slots_;
  uint32_t last_ = ~0u;
};

/// Collects the adjacent voxel pairs of different manifolds whose first voxel lies in a leaf.
class EdgeCollector {
 public:
  EdgeCollector(const LeafIndex& index, const Flow& flow, const VoxelArray<int32_t>& power,
                EdgeTable& table)
      : index_(index), flow_(flow), power_(power), table_(table) {}

  void collect(size_t leaf) {
    load(leaf);
    uint64_t rows = detail::atBestLevel([&]() VDB_MADF_INLINE { return differingRows(); });
    for (; rows; rows &= rows - 1) {
      const int row = __builtin_ctzll(rows);
      collectRow(leaf, row >> 3, row & 7);
    }
  }

 private:
  static constexpr uint32_t kNumber = ~Flow::kOwnCell;

  /// Do two voxels (0: no object voxel) belong to different manifolds?
  static uint32_t differ(uint32_t a, uint32_t b) {
    return a != 0 && b != 0 ? (a ^ b) & kNumber : 0;
  }

  /// Spreads the leaf's manifolds over block_, with the faces of the next leaves.
  void load(size_t leaf) {
    uint32_t dense[512];
    detail::expandLeaf(index_.mask(leaf), flow_.manifold.data() + index_.firstRank(leaf), dense);
    for (size_t x = 0; x < 8; ++x)
      for (size_t y = 0; y < 8; ++y) std::copy_n(dense + x * 64 + y * 8, 8, block_[x][y]);
    const LeafIndex::Neighbors& next = index_.neighbors(leaf);
    for (uint32_t i = 0; i < 8; ++i) {
      for (uint32_t j = 0; j < 8; ++j) {
        block_[8][i][j] = value(next[1], i * 8 + j);
        block_[i][8][j] = value(next[3], i * 64 + j);
        block_[i][j][8] = value(next[5], i * 64 + j * 8);
      }
    }
  }
  uint32_t value(uint32_t leaf, uint32_t offset) const {
    if (leaf == LeafIndex::kNone) return 0;
    const VoxelId id = leaf * 512 + offset;
    return detail::isObject(index_, id) ? flow_.manifold[index_.rank(id)] : 0;
  }

  /// Is there any pair of different manifolds from the row (x, y) on? Mostly not. Bit x*8 + y.
  VDB_MADF_KERNEL uint64_t differingRows() const {
    uint64_t rows = 0;
    for (int x = 0; x < 8; ++x)
      for (int y = 0; y < 8; ++y) {
        uint32_t any = 0;
        for (int z = 0; z < 8; ++z) {
          const uint32_t a = block_[x][y][z];
          any |= differ(a, block_[x][y][z + 1]) | differ(a, block_[x][y + 1][z]) |
                 differ(a, block_[x + 1][y][z]);
        }
        rows |= uint64_t(any != 0) << (x * 8 + y);
      }
    return rows;
  }

  void collectRow(size_t leaf, int x, int y) {
    for (int z = 0; z < 8; ++z) {
      collectPair(leaf, {x, y, z}, {x, y, z + 1});
      collectPair(leaf, {x, y, z}, {x, y + 1, z});
      collectPair(leaf, {x, y, z}, {x + 1, y, z});
    }
  }

  void collectPair(size_t leaf, const Coord& p, const Coord& q) {
    const uint32_t a = block_[p.x()][p.y()][p.z()], b = block_[q.x()][q.y()][q.z()];
    if (!differ(a, b)) return;
    const uint32_t first = (a & kNumber) - 1, second = (b & kNumber) - 1;
    table_.add({std::min(first, second), std::max(first, second), 1,
                -std::max(powerAt(leaf, p), powerAt(leaf, q)), (a & b & Flow::kOwnCell) != 0});
  }

  /// Power at a place of the block; 8 is the first voxel of the next leaf.
  int32_t powerAt(size_t leaf, const Coord& p) const {
    for (size_t axis = 0; axis < 3; ++axis)
      if (p[axis] == 8) leaf = index_.neighbors(leaf)[2 * axis + 1];
    return power_[index_.rank(VoxelId(leaf * 512) +
                              VoxelId((p.x() & 7) * 64 + (p.y() & 7) * 8 + (p.z() & 7)))];
  }

  const LeafIndex& index_;
  const Flow& flow_;
  const VoxelArray<int32_t>& power_;
  EdgeTable& table_;
  uint32_t block_[9][9][9] = {};
};

}  // namespace

void detail::reduceEdges(std::vector<Edge>& edges) {
  parallelSort(edges.begin(), edges.end(), pairLess);
  size_t count = 0;
  for (const Edge& edge : edges) {
    if (count > 0 && samePair(edges[count - 1], edge))
      accumulate(edges[count - 1], edge);
    else
      edges[count++] = edge;
  }
  edges.resize(count);
}

ManifoldGraph manifoldGraph(const LeafIndex& index, const Flow& flow,
                            const VoxelArray<int32_t>& power, Interrupter* interrupter) {
  constexpr size_t kLeavesPerTable = 1024;
  std::vector<Edge> edges;
  std::mutex edgesMutex;
  detail::PerThread<EdgeTable> tables;
  detail::parallelFor(index.leafCount(), kLeavesPerTable, interrupter,
                      [&](size_t begin, size_t end) {
                        EdgeTable& table = tables.local();
                        table.clear();
                        EdgeCollector collector(index, flow, power, table);
                        for (size_t leaf = begin; leaf < end; ++leaf) collector.collect(leaf);
                        const std::lock_guard<std::mutex> lock(edgesMutex);
                        edges.insert(edges.end(), table.edges().begin(), table.edges().end());
                      });
  detail::reduceEdges(edges);
  return {flow.criticalPoints, std::move(edges)};
}

}  // namespace vdb_madf
