// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/method/manifold_graph.h"

#include <algorithm>
#include <limits>
#include <mutex>

#include "vdb_madf/base/detail/bits.h"
#include "vdb_madf/base/detail/parallel.h"
#include "vdb_madf/base/detail/simd.h"
#include "vdb_madf/leaves/detail/leaf_faces.h"
#include "vdb_madf/leaves/detail/leaf_mask.h"
#include "vdb_madf/leaves/detail/leaf_values.h"
#include "vdb_madf/method/detail/ball_reach.h"
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
    last_ = kEmpty;
    slots_.assign(slots_.empty() ? 256 : slots_.size(), {0, kEmpty});
  }

  /// One more face between two manifolds.
  void add(uint32_t first, uint32_t second, int32_t height, bool cellsTouch) {
    const uint64_t pair = uint64_t(first) << 32 | second;
    if (pair != lastPair_ || last_ == kEmpty) {
      lastPair_ = pair;
      last_ = find(pair);
    }
    Edge& edge = edges_[last_];
    ++edge.contactFaces;
    edge.saddleHeight = std::max(edge.saddleHeight, height);
    edge.cellsTouch |= cellsTouch;
  }

  const std::vector<Edge>& edges() const { return edges_; }

 private:
  static constexpr uint32_t kEmpty = ~0u;
  struct Slot {
    uint64_t pair;
    uint32_t edge;
  };

  size_t home(uint64_t pair) const {
    return size_t(pair * 0x9e3779b97f4a7c15ull >> 32) & (slots_.size() - 1);  // Fibonacci hashing
  }

  /// The slot of a pair, or the empty one that it is to get.
  size_t slotOf(uint64_t pair) const {
    size_t slot = home(pair);
    while (slots_[slot].edge != kEmpty && slots_[slot].pair != pair)
      slot = (slot + 1) & (slots_.size() - 1);
    return slot;
  }

  /// The place of a pair's edge, which is a new one if need be.
  uint32_t find(uint64_t pair) {
    Slot& slot = slots_[slotOf(pair)];
    if (slot.edge != kEmpty) return slot.edge;
    const uint32_t edge = uint32_t(edges_.size());
    slot = {pair, edge};
    edges_.push_back({uint32_t(pair >> 32), uint32_t(pair), 0, kNoHeight, false});
    if (edges_.size() * 2 > slots_.size()) grow();
    return edge;
  }

  void grow() {
    std::vector<Slot> old(slots_.size() * 2, {0, kEmpty});
    old.swap(slots_);
    for (const Slot& slot : old)
      if (slot.edge != kEmpty) slots_[slotOf(slot.pair)] = slot;
  }

  static constexpr int32_t kNoHeight = std::numeric_limits<int32_t>::min();
  std::vector<Edge> edges_;
  std::vector<Slot> slots_;
  uint64_t lastPair_ = 0;
  uint32_t last_ = kEmpty;
};

/// The values of a leaf and of the faces of the next leaves beside it; 0 where there is no object
/// voxel.
struct Block {
  uint32_t own[8][64];  ///< of (x, y, z) at [x][y * 8 + z]
  uint32_t next[3][64];

  template <typename T>
  void load(const LeafIndex& index, const VoxelArray<T>& values, uint32_t leaf) {
    const auto* const first = reinterpret_cast<const uint32_t*>(values.data());
    detail::expandLeaf(index.mask(leaf), first + index.firstRank(leaf), own[0]);
    for (int axis = 0; axis < 3; ++axis)
      detail::copyFace(index, first, index.neighbors(leaf)[size_t(2 * axis + 1)], axis, 0,
                       next[axis]);
  }
  /// The value one step along an axis from a voxel, of x and y * 8 + z.
  uint32_t after(int axis, uint32_t x, uint32_t yz) const {
    const uint32_t y = yz >> 3, z = yz & 7;
    if (axis == 0) return x < 7 ? own[x + 1][yz] : next[0][yz];
    if (axis == 1) return y < 7 ? own[x][yz + 8] : next[1][x * 8 + z];
    return z < 7 ? own[x][yz + 1] : next[2][x * 8 + y];
  }
};

constexpr uint32_t kNumber = ~Flow::kOwnCell;

/// Bit i: are own[i] and other[i] of different manifolds? (Some one, where one is no object voxel.)
VDB_MADF_KERNEL uint64_t differing(const uint32_t* own, const uint32_t* other) {
  uint8_t differ[64];
  for (size_t i = 0; i < 64; ++i) differ[i] = ((own[i] ^ other[i]) & kNumber) != 0;
  return detail::wordOfBytes(differ);
}

/// differing() of a plane of the block and what follows it along each axis.
VDB_MADF_KERNEL void differingAfter(const Block& block, uint32_t x, uint64_t* bits) {
  const uint32_t* const own = block.own[x];
  uint32_t other[64];
  bits[0] = differing(own, x < 7 ? block.own[x + 1] : block.next[0]);
  std::copy_n(own + 8, 56, other);
  std::copy_n(&block.next[1][x * 8], 8, other + 56);
  bits[1] = differing(own, other);
  std::copy_n(own + 1, 63, other);
  for (uint32_t y = 0; y < 8; ++y) other[y * 8 + 7] = block.next[2][x * 8 + y];
  bits[2] = differing(own, other);
}

/// Collects the adjacent voxel pairs of different manifolds whose first voxel lies in a leaf.
class EdgeCollector {
 public:
  EdgeCollector(const LeafIndex& index, const Flow& flow, const VoxelArray<int32_t>& power,
                EdgeTable& table)
      : index_(index), flow_(flow), power_(power), table_(table) {}

  void collect(uint32_t leaf) {
    manifold_.load(index_, flow_.manifold, leaf);
    uint64_t pairs[8][3];
    detail::atBestLevel([&]() VDB_MADF_INLINE {
      for (uint32_t x = 0; x < 8; ++x) differingAfter(manifold_, x, pairs[x]);
    });
    const LeafIndex::Mask& mask = index_.mask(leaf);
    const uint64_t next[3] = {faceOfNext(leaf, 0), faceOfNext(leaf, 1), faceOfNext(leaf, 2)};
    uint64_t any = 0;
    for (uint32_t x = 0; x < 8; ++x) {
      pairs[x][0] &= mask[x] & (x < 7 ? mask[x + 1] : next[0]);
      pairs[x][1] &= mask[x] & (mask[x] >> 8 | next[1] >> (8 * x) << 56);
      pairs[x][2] &=
          mask[x] & ((mask[x] >> 1 & ~detail::kLastZ) | spreadToLastZ(next[2] >> (8 * x)));
      any |= pairs[x][0] | pairs[x][1] | pairs[x][2];
    }
    if (!any) return;
    powers_.load(index_, power_, leaf);
    for (uint32_t x = 0; x < 8; ++x)
      for (int axis = 0; axis < 3; ++axis)
        detail::forEachBit(pairs[x][axis], [&](int bit) { add(axis, x, uint32_t(bit)); });
  }

 private:
  uint64_t faceOfNext(uint32_t leaf, int axis) const {
    return detail::faceMask(index_, index_.neighbors(leaf)[size_t(2 * axis + 1)], axis, 0);
  }
  /// Bit y of a byte to bit y * 8 + 7.
  static uint64_t spreadToLastZ(uint64_t byte) {
    uint64_t bits = 0;
    for (int y = 0; y < 8; ++y) bits |= (byte >> y & 1) << (y * 8 + 7);
    return bits;
  }

  void add(int axis, uint32_t x, uint32_t yz) {
    const uint32_t a = manifold_.own[x][yz], b = manifold_.after(axis, x, yz);
    const uint32_t first = (a & kNumber) - 1, second = (b & kNumber) - 1;
    const int32_t height =
        -std::max(int32_t(powers_.own[x][yz]), int32_t(powers_.after(axis, x, yz)));
    table_.add(std::min(first, second), std::max(first, second), height,
               (a & b & Flow::kOwnCell) != 0);
  }

  const LeafIndex& index_;
  const Flow& flow_;
  const VoxelArray<int32_t>& power_;
  EdgeTable& table_;
  Block manifold_, powers_;
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
  constexpr size_t kLeavesPerTable = 1024, kEdgesPerTable = 1 << 15;
  std::vector<std::vector<Edge>> parts;
  std::mutex partsMutex;
  detail::PerThread<EdgeTable> tables;
  detail::parallelFor(index.leafCount(), kLeavesPerTable, interrupter,
                      [&](size_t begin, size_t end) {
                        EdgeTable& table = tables.local();
                        table.clear();
                        const auto empty = [&] {
                          const std::lock_guard<std::mutex> lock(partsMutex);
                          parts.push_back(table.edges());
                          table.clear();
                        };
                        EdgeCollector collector(index, flow, power, table);
                        for (size_t leaf = begin; leaf < end; ++leaf) {
                          collector.collect(uint32_t(leaf));
                          if (table.edges().size() > kEdgesPerTable) empty();
                        }
                        empty();
                      });
  std::vector<Edge> edges = detail::concatenated(std::move(parts));
  detail::reduceEdges(edges);
  return {flow.criticalPoints, std::move(edges)};
}

void placeGraph(ManifoldGraph& graph, const Domain& domain, bool open) {
  graph.flatAxis = domain.flatAxis();
  for (CriticalPoint& node : graph.nodes)
    node.doubt = open && detail::reachesOut(node, domain, graph.weights) ? node.squaredRadius : 0;
}

}  // namespace vdb_madf
