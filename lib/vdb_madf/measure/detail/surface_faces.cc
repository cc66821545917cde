// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/measure/detail/surface_faces.h"

#include <algorithm>
#include <cmath>

#include "vdb_madf/base/detail/simd.h"

namespace vdb_madf::detail {

namespace {

/// Twice the coordinate of a face out of everyone's reach, whose square fits in 16 bits.
constexpr int16_t kFarAway = 100;

/// Bit z + 8 for z from `begin` to `last`.
constexpr uint32_t bitsOf(int begin, int last) {
  return (2u << (last + 8)) - (1u << (begin + 8));
}

/// \p low and \p high: rows that follow each other, of `count` places.
[[gnu::always_inline]] inline uint32_t overlap(const uint32_t* low, const uint32_t* high, int shift,
                                               uint32_t within, int count, uint32_t* both) {
  uint32_t any = 0;
  for (int i = 0; i < count; ++i) any |= both[i] = low[i] & high[i] >> shift & within;
  return any;
}

}  // namespace

NormalReach::NormalReach(int doubled, int most, const VoxelShape& voxel) : isBall_(voxel.isCube()) {
  for (size_t axis = 0; axis < 3; ++axis) {
    const double radius =
        std::min<double>(most, doubled * voxel.longestEdge() / voxel.edges[int(axis)]);
    radii_[axis] = int(std::ceil(radius));
    // Rounded up: no face has a weight at the radius, where some are left out.
    factors_[axis] = int32_t(std::ceil(kWeight / (radius * radius)));
  }
}

void addTargets(const WindowRows& own, const WindowRows& other, int axis, int step, int side,
                std::vector<SurfaceTarget>& targets) {
  constexpr uint32_t kLeaf = bitsOf(0, 7);
  const int dx = axis == 0 ? step : 0, dy = axis == 1 ? step : 0, dz = axis == 2 ? step : 0;
  for (int x = 0; x < 8; ++x) {
    const uint32_t* from = own.line(x) - WindowRows::kBegin;
    const uint32_t* to = other.line(x + dx) - WindowRows::kBegin + dy;
    uint32_t words[8], any = 0;
    for (int y = 0; y < 8; ++y)
      any |= words[y] = from[y] & (dz < 0 ? to[y] << 1 : to[y] >> dz) & kLeaf;
    if (!any) continue;
    for (int y = 0; y < 8; ++y)
      for (uint32_t bits = words[y]; bits; bits &= bits - 1)
        targets.push_back({{int16_t(2 * x + dx), int16_t(2 * y + dy),
                            int16_t(2 * (__builtin_ctz(bits) - 8) + dz)},
                           int16_t(side)});
  }
}

/// Collects the faces of a side whose lower voxel has an x.
VDB_MADF_KERNEL void SurfaceFaces::collect(const WindowRows& first, const WindowRows& second,
                                           const FaceRange& range, int side, int x) {
  const int axis = side >> 1;
  if (axis != 0 && x == range.begin[0]) return;
  const WindowRows& lower = side & 1 ? second : first;
  const WindowRows& upper = side & 1 ? first : second;
  uint32_t words[WindowRows::kLine];
  if (!overlap(lower.line(x), upper.line(x + (axis == 0)) + (axis == 1), axis == 2,
               bitsOf(range.begin[2] + (axis != 2), range.last[2]), WindowRows::kLine, words))
    return;
  List& list = lists_[size_t(side)];
  size_t n = list.count;
  for (int y = range.begin[1] + (axis != 1); y <= range.last[1]; ++y) {
    for (uint32_t bits = words[y - WindowRows::kBegin]; bits; bits &= bits - 1, ++n) {
      list.x[n] = int16_t(2 * x + (axis == 0));
      list.y[n] = int16_t(2 * y + (axis == 1));
      list.z[n] = int16_t(2 * (__builtin_ctz(bits) - 8) + (axis == 2));
    }
  }
  list.count = n;
}

void SurfaceFaces::collect(const WindowRows& first, const WindowRows& second,
                           const FaceRange& range) {
  for (size_t side = 0; side < 6; ++side) {
    List& list = lists_[side];
    if (list.x.empty())
      for (auto* coordinates : {&list.x, &list.y, &list.z}) coordinates->resize(kRoom);
    list.count = 0;
    for (int x = WindowRows::kBegin; x <= WindowRows::kEnd; ++x) {
      list.from[size_t(x - WindowRows::kBegin)] = uint32_t(list.count);
      if (x >= range.begin[0] && x <= range.last[0])
        atBestLevel([&]() VDB_MADF_INLINE { collect(first, second, range, int(side), x); });
    }
    std::fill_n(list.x.begin() + std::ptrdiff_t(list.count), kTogether, kFarAway);
  }
}

/// Centers 2 x (+ 1) with |2 x (+ 1) - target| < reach.
[[gnu::always_inline]] inline SurfaceFaces::Blocks SurfaceFaces::blocksInReach(const List& list,
                                                                               bool alongX,
                                                                               int target,
                                                                               int reach) {
  const auto firstAt = [&](int x) {
    return size_t(list.from[size_t(std::clamp(x - WindowRows::kBegin, 0, kSide))]);
  };
  return {firstAt(((target - reach - alongX) >> 1) + 1),
          firstAt((target + reach - alongX + 1) >> 1)};
}

/// Adds up the weights of a list's faces for each target, but for those of a side. In 16 bits:
/// coordinates differ by 32 at most but for kFarAway; a sum is over the faces of one axis in reach,
/// fewer than 300, of weight 64 at most.
VDB_MADF_KERNEL void SurfaceFaces::addWeightsInBall(const List& list, bool alongX,
                                                    const SurfaceTarget* begin,
                                                    const SurfaceTarget* end, int reach,
                                                    int skippedSide, int32_t* sums) {
  const auto squaredReach = int16_t(reach * reach);
  for (const SurfaceTarget* target = begin; target != end; ++target, ++sums) {
    *sums = 0;
    if (target->side == skippedSide) continue;
    const int16_t tx = target->center[0], ty = target->center[1], tz = target->center[2];
    const auto [from, to] = blocksInReach(list, alongX, tx, reach);
    int16_t lanes[kTogether] = {};
    for (size_t block = from; block < to; block += kTogether) {
      const int16_t *x = &list.x[block], *y = &list.y[block], *z = &list.z[block];
      for (size_t lane = 0; lane < kTogether; ++lane) {
        const auto dx = int16_t(x[lane] - tx), dy = int16_t(y[lane] - ty),
                   dz = int16_t(z[lane] - tz);
        const auto rest = int16_t(squaredReach - dx * dx - dy * dy - dz * dz);
        lanes[lane] = int16_t(lanes[lane] + (rest > 0 ? rest : int16_t(0)));
      }
    }
    int16_t sum = 0;
    for (size_t lane = 0; lane < kTogether; ++lane) sum = int16_t(sum + lanes[lane]);
    *sums = sum;
  }
}

/// Adds weights in any reach. They fit in 32 bits: distances are below 2^8, factors 2^18 / 25 at
/// most, and fewer than 2^13 faces of one side fit into the window.
VDB_MADF_KERNEL void SurfaceFaces::addWeights(const List& list, bool alongX,
                                              const SurfaceTarget* begin, const SurfaceTarget* end,
                                              const NormalReach& reach, int skippedSide,
                                              int32_t* sums) {
  const int32_t fx = reach.factor(0), fy = reach.factor(1), fz = reach.factor(2);
  for (const SurfaceTarget* target = begin; target != end; ++target, ++sums) {
    *sums = 0;
    if (target->side == skippedSide) continue;
    const int32_t tx = target->center[0], ty = target->center[1], tz = target->center[2];
    const auto [from, to] = blocksInReach(list, alongX, tx, reach.radius(0));
    int32_t lanes[kTogether] = {};
    for (size_t block = from; block < to; block += kTogether) {
      const int16_t *x = &list.x[block], *y = &list.y[block], *z = &list.z[block];
      for (size_t lane = 0; lane < kTogether; ++lane) {
        const int32_t dx = x[lane] - tx, dy = y[lane] - ty, dz = z[lane] - tz;
        const int32_t rest = NormalReach::kWeight - fx * dx * dx - fy * dy * dy - fz * dz * dz;
        lanes[lane] += rest > 0 ? rest : 0;
      }
    }
    int32_t sum = 0;
    for (size_t lane = 0; lane < kTogether; ++lane) sum += lanes[lane];
    *sums = sum;
  }
}

int64_t SurfaceFaces::area(const SurfaceTarget* begin, const SurfaceTarget* end,
                           const NormalReach& reach, bool oneSheet) {
  const auto count = size_t(end - begin);
  for (size_t side = 0; side < 6; ++side) {
    sums_[side].resize(std::max(count, sums_[side].size()));
    const int opposite = oneSheet ? int(side ^ 1) : -1;
    atBestLevel([&]() VDB_MADF_INLINE {
      if (reach.isBall())
        addWeightsInBall(lists_[side], side < 2, begin, end, reach.radius(0), opposite,
                         sums_[side].data());
      else
        addWeights(lists_[side], side < 2, begin, end, reach, opposite, sums_[side].data());
    });
  }
  int64_t area = 0;
  for (size_t i = 0; i < count; ++i) {
    double normal[3];
    for (size_t axis = 0; axis < 3; ++axis)
      normal[axis] = faceAreas_[axis] * (sums_[2 * axis][i] - sums_[2 * axis + 1][i]);
    const int side = begin[i].side;
    const double along = side & 1 ? -normal[side >> 1] : normal[side >> 1];
    if (!(along > 0)) continue;
    const double length =
        std::sqrt(normal[0] * normal[0] + normal[1] * normal[1] + normal[2] * normal[2]);
    // Sums are small integers: of cubes no cosine is half of a unit, and this rounds to the
    // nearest.
    area += int64_t(kAreaUnit * faceAreas_[size_t(side >> 1)] * (along / length) + 0.5);
  }
  return area;
}

}  // namespace vdb_madf::detail
