// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

// A pass of the power map along 64 rows at a time, on plain arrays, for balls that are not large:
// every position looks at all sites in reach, 16 positions at a time. (lower_envelope.h is for the
// others.)

namespace vdb_madf::detail {

/// Where no D is larger, power and D fit into one number of 32 bits, a *key*
///   power 2^shift - D,  2^shift > max D.
/// The smaller key is that of the smaller power and, of equal powers, of the larger D.
constexpr int32_t kLargestKeyedSquaredRadius = (1 << 15) - 1;

/// The least shift for D up to `largest`.
inline int keyShift(int32_t largest) {
  int shift = 1;
  while (largest >> shift) ++shift;
  return shift;
}
/// The key of a ball at its own center.
inline int32_t keyOfBall(int32_t squaredRadius, int shift) {
  return -(squaredRadius << shift) - squaredRadius;
}
/// The power of a key below 0; it is negative, too, if the key is below -2^shift.
inline int32_t powerOfKey(int32_t key, int shift) {
  return (key >> shift) + 1;
}

/// Voxels along an axis of that weight within which a ball of squared radius `largest` has a
/// negative power.
int keyReach(int32_t largest, int32_t weight);

/// The 64 rows of a pencil in lines: 64 lines of one row (stride 1), or 4 lines of 16 rows side by
/// side (stride 16), position after position. Around a line is padding, as far as sites reach.
struct KeyLines {
  std::vector<int32_t>
      key;  ///< a site: < 0; an object voxel without: kNotNegative (lower_envelope.h); else 0
  std::vector<uint32_t> site;  ///< where the key is negative
  std::vector<int32_t> leastKey;
  std::vector<uint32_t> leastSite;  ///< where leastKey is negative, so is the power

  /// Makes room for rows of `length` positions, a multiple of 8. Clears the padding; never shrinks.
  void resize(int stride, int length, int reach);
  /// The place of a position, -reach() to length + reach() - 1, of the first row of a line.
  size_t at(int line, int position) const {
    return size_t(line) * pitch_ + size_t((padding_ + position) * stride_);
  }
  int stride() const { return stride_; }
  int length() const { return length_; }
  int reach() const { return reach_; }

 private:
  int stride_ = 0, length_ = 0, reach_ = 0, padding_ = 0;
  size_t pitch_ = 0;
};

/// Computes for each row and its object voxels t
///   leastKey(t) = min over the sites s of the row of key(s) + 2^shift w (s - t)^2,
/// leastSite(t) = site(s), at equal keys of the smaller s; kNotNegative, and any site, where no
/// power is negative. Anything at other voxels. `weight`, w, is that of the axis; no site reaches
/// further than lines.reach().
void leastKeys(int shift, int32_t weight, KeyLines& lines);

}  // namespace vdb_madf::detail
