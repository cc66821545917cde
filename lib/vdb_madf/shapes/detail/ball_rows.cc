// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/shapes/detail/ball_rows.h"

#include <algorithm>
#include <cmath>

#include "vdb_madf/base/detail/bits.h"
#include "vdb_madf/base/detail/simd.h"
#include "vdb_madf/method/detail/metric.h"

namespace vdb_madf::detail {

namespace {

/// The largest whole number of voxels along an axis whose square is at most that.
int reachOf(int64_t square, int32_t weight) {
  return int(std::sqrt(double(square / weight)));  // exact: squares are below 2^31
}

BallRows makeRows(double squaredRadius, const VoxelWeights& weights) {
  BallRows rows;
  // Whole numbers below the squared radius are those up to this one.
  const int64_t last = int64_t(std::ceil(squaredRadius)) - 1;
  if (last < 0) return rows;
  rows.reachX = reachOf(last, weights.x);
  rows.reachY = reachOf(last, weights.y);
  const bool hasMasks =
      std::max({rows.reachX, rows.reachY, reachOf(last, weights.z)}) <= BallRows::kMaxReach;
  for (int x = -rows.reachX; x <= rows.reachX; ++x)
    for (int y = -rows.reachY; y <= rows.reachY; ++y) {
      const int64_t rest =
          last - squaredAlong(int64_t(x), weights.x) - squaredAlong(int64_t(y), weights.y);
      const int half = rest < 0 ? -1 : reachOf(rest, weights.z);
      rows.voxels += 2 * half + 1 + (half < 0);
      if (hasMasks)
        rows.masks.push_back(half < 0 ? 0 : ((uint64_t(2) << 2 * half) - 1) << (32 - half));
    }
  return rows;
}

}  // namespace

const BallRows& BallRowsCache::of(double squaredRadius) {
  if (rows_.size() == kMaxRadii && !rows_.count(squaredRadius)) rows_.clear();
  const auto [place, isNew] = rows_.try_emplace(squaredRadius);
  if (isNew) place->second = makeRows(squaredRadius, weights_);
  return place->second;
}

namespace {

VDB_MADF_KERNEL int64_t countMaskedKernel(const MaskedRows& rows) {
  const int up = std::max(rows.shift, 0), down = std::max(-rows.shift, 0);
  int64_t sum = 0;
  for (int x = 0; x < rows.countX; ++x) {
    const uint64_t* words = rows.words + size_t(x) * rows.wordsPerX;
    const uint64_t* masks = rows.masks + size_t(x) * rows.masksPerX;
    for (int y = 0; y < rows.countY; ++y)
      sum += countBits(words[size_t(y) * rows.wordsPerY] & (masks[y] << up >> down));
  }
  return sum;
}

}  // namespace

int64_t countMasked(const MaskedRows& rows) {
  return atBestLevel([&]() VDB_MADF_INLINE { return countMaskedKernel(rows); });
}

}  // namespace vdb_madf::detail
