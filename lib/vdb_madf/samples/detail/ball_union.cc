// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/samples/detail/ball_union.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <tuple>

#include "vdb_madf/base/detail/bits.h"
#include "vdb_madf/base/detail/parallel.h"

namespace vdb_madf::detail {

namespace {

using Node = MaskBlocks::Node;
using Leaf = MaskBlocks::Leaf;

/// The bits of one ball in one leaf: word x, bit y*8 + z, as in the leaf's mask.
using LeafBits = uint64_t[8];

/// The rows of a ball in one column of leaves, along z.
struct LeafColumn {
  RowRange rows[64];  // at x*8 + y
  int zMin, zMax;

  LeafColumn(const Ball& ball, const Lattice& lattice, const CoordBBox& box, int leafX, int leafY)
      : zMin(box.max().z() + 1), zMax(box.min().z() - 1) {
    const int x0 = std::max(leafX, box.min().x()), x1 = std::min(leafX + 7, box.max().x());
    const int y0 = std::max(leafY, box.min().y()), y1 = std::min(leafY + 7, box.max().y());
    for (int x = x0; x <= x1; ++x)
      for (int y = y0; y <= y1; ++y) {
        const RowRange row = ballRow(ball, x, y, box.min().z(), box.max().z(), lattice);
        rows[(x - leafX) * 8 + (y - leafY)] = row;
        if (row.last < row.first) continue;
        zMin = std::min(zMin, row.first);
        zMax = std::max(zMax, row.last);
      }
  }

  void bits(int leafZ, LeafBits& words) const {
    for (int x = 0; x < 8; ++x) {
      words[x] = 0;
      for (int y = 0; y < 8; ++y) {
        const int first = std::max(rows[x * 8 + y].first - leafZ, 0);
        const int last = std::min(rows[x * 8 + y].last - leafZ, 7);
        if (first > last) continue;
        words[x] |= uint64_t((0xffu << first) & (0xffu >> (7 - last))) << (8 * y);
      }
    }
  }
};

/// Calls visit(leafOrigin, bits) for each leaf of the box that the ball may meet.
template <typename Visit>
void visitLeaves(const Ball& ball, const Lattice& lattice, const CoordBBox& within,
                 const Visit& visit) {
  CoordBBox box = ballBox(ball, lattice);
  box.intersect(within);
  if (box.empty()) return;
  LeafBits words;
  for (int x = box.min().x() & ~7; x <= box.max().x(); x += 8)
    for (int y = box.min().y() & ~7; y <= box.max().y(); y += 8) {
      const LeafColumn column(ball, lattice, box, x, y);
      for (int z = column.zMin & ~7; z <= column.zMax; z += 8) {
        column.bits(z, words);
        visit(Coord(x, y, z), words);
      }
    }
}

int64_t countNewIn(const Node* node, const CoordBBox& box, const Ball& ball,
                   const Lattice& lattice) {
  int64_t added = 0;
  visitLeaves(ball, lattice, box, [&](const Coord& origin, LeafBits& words) {
    if (node) {
      if (const Leaf* leaf = node->probeConstLeaf(origin)) {
        for (int x = 0; x < 8; ++x) words[x] &= ~leaf->getValueMask().getWord<uint64_t>(x);
      } else if (node->isValueOn(origin)) {
        return;
      }
    }
    added += countBitsIn(words);
  });
  return added;
}

int64_t addTo(Node& node, const CoordBBox& box, const Ball& ball, const Lattice& lattice,
              bool fullLeavesAsTiles) {
  int64_t added = 0;
  visitLeaves(ball, lattice, box, [&](const Coord& origin, const LeafBits& words) {
    Leaf* leaf = node.probeLeaf(origin);
    if (!leaf) {
      if (node.isValueOn(origin)) return;
      if (countBitsIn(words) == 0) return;
      leaf = node.touchLeaf(origin);
    }
    uint64_t all = ~uint64_t(0);
    for (int x = 0; x < 8; ++x) {
      uint64_t& word = leaf->getValueMask().getWord<uint64_t>(x);
      added += countBits(words[x] & ~word);
      word |= words[x];
      all &= word;
    }
    if (fullLeavesAsTiles && all == ~uint64_t(0)) MaskBlocks::makeTile(node, origin);
  });
  return added;
}

}  // namespace

void sortByCenter(std::vector<Ball>& balls) {
  std::stable_sort(balls.begin(), balls.end(), [](const Ball& a, const Ball& b) {
    return std::tie(a.x, a.y, a.z) < std::tie(b.x, b.y, b.z);
  });
}

RowRange ballRow(const Ball& ball, int x, int y, int zMin, int zMax, const Lattice& lattice) {
  const double dx = lattice.place(0, x) - ball.x, dy = lattice.place(1, y) - ball.y;
  const double inPlane = dx * dx + dy * dy, square = ball.radius * ball.radius;
  if (!(inPlane < square)) return {zMin, zMin - 1};
  const auto inside = [&](int z) {
    const double dz = lattice.place(2, z) - ball.z;
    return inPlane + dz * dz < square;
  };
  // The root gives the ends to within a voxel, the comparison decides.
  const double half = std::sqrt(square - inPlane);
  int first = std::max(zMin, int(lattice.index(2, ball.z - half)) - 1);
  int last = std::min(zMax, int(lattice.index(2, ball.z + half)) + 1);
  while (first <= last && !inside(first)) ++first;
  while (first <= last && !inside(last)) --last;
  return {first, last};
}

CoordBBox ballBox(const Ball& ball, const Lattice& lattice) {
  const double center[] = {ball.x, ball.y, ball.z};
  CoordBBox box;
  for (int axis = 0; axis < 3; ++axis) {
    box.min()[axis] = int(lattice.index(axis, center[axis] - ball.radius)) - 1;
    box.max()[axis] = int(lattice.index(axis, center[axis] + ball.radius)) + 1;
  }
  return box;
}

template <typename Visit>
void BallUnion::visitBlocks(const Ball& ball, const Visit& visit) const {
  CoordBBox box = ballBox(ball, lattice_);
  box.intersect(part_);
  if (box.empty()) return;
  const CoordBBox range = blocks_.blocksOf(box);
  for (int x = range.min().x(); x <= range.max().x(); ++x)
    for (int y = range.min().y(); y <= range.max().y(); ++y)
      for (int z = range.min().z(); z <= range.max().z(); ++z) visit(blocks_.indexOf({x, y, z}));
}

int64_t BallUnion::countNew(const Ball& ball) const {
  int64_t added = 0;
  visitBlocks(ball, [&](size_t block) {
    added += countNewIn(blocks_.probe(block), blocks_.box(block), ball, lattice_);
  });
  return added;
}

void BallUnion::add(const Ball& ball) {
  visitBlocks(ball, [&](size_t block) {
    voxelCount_ += addTo(blocks_.node(block), blocks_.box(block), ball, lattice_, tiles_);
  });
}

void BallUnion::add(const std::vector<Ball>& balls, Interrupter* interrupter) {
  std::vector<std::vector<uint32_t>> ballsOf(blocks_.count());
  for (size_t i = 0; i < balls.size(); ++i)
    visitBlocks(balls[i], [&](size_t block) { ballsOf[block].push_back(uint32_t(i)); });

  // A union and its count do not depend on the order of the balls.
  std::atomic<int64_t> added{0};
  parallelForEach(blocks_.count(), 1, interrupter, [&](size_t block) {
    if (ballsOf[block].empty()) return;
    int64_t here = 0;
    for (const uint32_t i : ballsOf[block])
      here += addTo(blocks_.node(block), blocks_.box(block), balls[i], lattice_, tiles_);
    added += here;
  });
  voxelCount_ += added;
}

}  // namespace vdb_madf::detail
