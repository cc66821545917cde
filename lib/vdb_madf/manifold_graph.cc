// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/manifold_graph.h"

#include <tbb/parallel_sort.h>

#include <algorithm>
#include <mutex>

#include "vdb_madf/detail/parallel.h"
#include "vdb_madf/detail/voxels.h"
#include "vdb_madf/flow.h"

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

void sortAndReduce(std::vector<Edge>& edges) {
  tbb::parallel_sort(edges.begin(), edges.end(), pairLess);
  size_t count = 0;
  for (const Edge& edge : edges) {
    if (count > 0 && samePair(edges[count - 1], edge))
      accumulate(edges[count - 1], edge);
    else
      edges[count++] = edge;
  }
  edges.resize(count);
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
    const LeafIndex::Mask& mask = index_.mask(leaf);
    const LeafIndex::Neighbors& next = index_.neighbors(leaf);
    constexpr uint64_t kLastZ = 0x8080808080808080ull;
    for (size_t x = 0; x < 8; ++x) {
      const uint64_t word = mask[x];
      if (!word) continue;
      const VoxelId base = VoxelId(leaf * 512 + x * 64);
      pairs(base, word & ~kLastZ & word >> 1, 1);
      pairs(base, word & word >> 8, 8);
      if (x < 7) pairs(base, word & mask[x + 1], 64);
      // Through the faces of the leaf.
      if (next[5] != LeafIndex::kNone)
        pairs(base, word & kLastZ & index_.mask(next[5])[x] << 7, step(leaf, next[5], -7));
      if (next[3] != LeafIndex::kNone)
        pairs(base, word & index_.mask(next[3])[x] << 56, step(leaf, next[3], -56));
      if (x == 7 && next[1] != LeafIndex::kNone)
        pairs(base, word & index_.mask(next[1])[0], step(leaf, next[1], -448));
    }
  }

 private:
  static int64_t step(size_t from, size_t to, int64_t offset) {
    return (int64_t(to) - int64_t(from)) * 512 + offset;
  }

  /// The pairs (p, p + step) for the bits p - base of a word.
  void pairs(VoxelId base, uint64_t word, int64_t step) {
    const uint32_t* manifold = flow_.manifold.data() + base;
    detail::forEachBit(word, [&](int bit) {
      const uint32_t a = manifold[bit], b = manifold[bit + step];
      if (a == b) return;
      const VoxelId p = base + VoxelId(bit), q = VoxelId(p + step);
      table_.add({std::min(a, b) - 1, std::max(a, b) - 1, 1, -std::max(power_[p], power_[q]),
                  flow_.direct.contains(p) && flow_.direct.contains(q)});
    });
  }

  const LeafIndex& index_;
  const Flow& flow_;
  const VoxelArray<int32_t>& power_;
  EdgeTable& table_;
};

}  // namespace

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
  sortAndReduce(edges);
  return {flow.criticalPoints, std::move(edges)};
}

}  // namespace vdb_madf
