// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <vector>

#include "vdb_madf/method/voxel_weights.h"

namespace vdb_madf::detail {

/// The voxels of a ball, which are those at less than its squared radius from its center.
struct BallRows {
  /// Farthest from the center that masks reach, in voxels.
  static constexpr int kMaxReach = 31;

  int64_t voxels = 0;
  /// The rows along z, with the center at bit 32: row (x, y) is number (x + reachX) * (2 * reachY +
  /// 1) + y + reachY. None if the ball reaches farther than kMaxReach.
  std::vector<uint64_t> masks;
  int reachX = 0, reachY = 0;
};

/// The rows of balls, counted once for each of the last kMaxRadii radii.
class BallRowsCache {
 public:
  static constexpr size_t kMaxRadii = 1024;  // at most 31 KiB each; cubes have fewer with masks

  explicit BallRowsCache(const VoxelWeights& weights) : weights_(weights) {}
  /// The rows of a ball, valid until the next call. \p squaredRadius: in units of the weights
  const BallRows& of(double squaredRadius);

 private:
  VoxelWeights weights_;
  std::map<double, BallRows> rows_;
};

/// Words of rows of voxels, under the masks of the rows of a ball.
struct MaskedRows {
  const uint64_t *words, *masks;
  size_t wordsPerX, wordsPerY, masksPerX;  ///< from one row to the next
  int countX, countY;                      ///< rows
  int shift;                               ///< of the masks upwards; downwards if less than 0
};
/// The set bits under the masks.
int64_t countMasked(const MaskedRows& rows);

}  // namespace vdb_madf::detail
