// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <optional>

#include "vdb_madf/method/voxel_weights.h"

// How well two touching classes of manifolds make one grain, in integers alone: the same on every
// machine. hierarchy.h says what it means.

namespace vdb_madf::detail {

/// floor(256 log2 n), for 0 < n < 2^43. The fraction n / 2^p in [1, 2), with 62 bits behind the
/// point, is squared eight times; each time it reaches 2 is a bit of the logarithm. What is cut off
/// could hide a bit only if 256 log2 n were within 2^-53 above an integer, and no n < 2^43 is (a
/// test looks at each that comes near).
inline int32_t lg(int64_t n) {
  const int highest = 63 - __builtin_clzll(uint64_t(n));
  uint64_t fraction = uint64_t(n) << (62 - highest);
  int32_t result = highest;
  for (int bit = 0; bit < 8; ++bit) {
    fraction = uint64_t((unsigned __int128)(fraction)*fraction >> 62);  // below 2^64
    const int reachesTwo = int(fraction >> 63);
    fraction >>= reachesTwo;
    result = 2 * result + reachesTwo;
  }
  return result;
}

/// floor(sqrt(n)), for n < 2^48.
inline int32_t squareRoot(int64_t n) {
  int64_t root = 0;
  for (int64_t bit = int64_t(1) << 23; bit > 0; bit >>= 1)
    if ((root + bit) * (root + bit) <= n) root += bit;
  return int32_t(root);
}

/// What the score needs of a class.
struct ScoredClass {
  int64_t voxels = 0;  ///< V, 1 to kMaxVoxels
  int32_t top = 0;     ///< m, its largest D
  int32_t sure = 0;  ///< s, the largest D of those of its balls that lie in the domain; 0: of none
};

/// The score of joining a class a with a class b, m_a <= m_b, over the faces F of their contact and
/// the highest saddle h between them, in units of 1/512.
///
/// Ranges: 1 <= V < 2^43, 0 <= F < 2^31, 0 <= s <= m, 1 <= h <= m < 2^31. Tops that are not sure
/// become smaller, but no less than h, and m_a stays the smaller one. Then nothing overflows:
/// - 65536 m < 2^47, so roots are below 2^24;
/// - V^2 < 2^86 and 18 m^3 < 2^98, in 128 bits; U_b^2 < 2^86, as U <= V (or 1);
/// - x^3 U_b^2 < 2^39 2^86 = 2^125 and (256 F)^3 < 2^117, in 128 bits;
/// - 0 <= 2 lg V <= 22014 and 0 <= u <= 22014, 18 rho <= 4608, 5 f <= 40955, 8 d < 2^27, the last
///   term at most 5376: the score is within 32 bits, at most 72953, and above -94.93 10^6.
///
/// In a plane, where V is an area and F a length:
/// - the disc is below 10 m < 2^35, so w < 2^45, x^2 w < 2^71 and (512 F)^2 < 2^80;
/// - u <= 11007, 16 rho <= 4096, 6 f <= 49146, the last term at most 3072: at most 89335.
///
/// Of V_b alone it depends by volumeTerm(), by f, which falls as V_b grows, and by m_b, which may
/// be taken for less while V_b <= V_a, so that rho and f are larger: if a, F, h, m_b and s_b stay,
/// the score less that term never grows with V_b. Nor does it grow with V_a, of which it depends by
/// U_a and the last term, until V_a reaches V_b: m_b may be taken for less from there on, and of
/// equal tops the other one becomes a.
class JoinScore {
 public:
  static constexpr int64_t kMaxVoxels = (int64_t(1) << 43) - 1, kMaxFaces = (int64_t(1) << 31) - 1;

  /// @param flatAxis all is in a plane, one voxel thick along it
  JoinScore(const VoxelWeights& weights, const std::optional<int>& flatAxis)
      : isFlat_(flatAxis.has_value()) {
    for (int axis = 0; axis < 3; ++axis) {
      if (flatAxis == axis) continue;
      const int32_t weight = weights[axis];
      shortest_ = shortest_ > 0 ? std::min(shortest_, weight) : weight;
      factor_ = std::gcd(factor_, weight);
      product_ *= uint64_t(weight);
    }
    for (int axis = 0; axis < 3; ++axis)
      if (flatAxis != axis) lgProduct_ += lg(weights[axis] / factor_);
  }

  int32_t operator()(ScoredClass a, ScoredClass b, int64_t faces, int32_t height) const {
    limitDoubtful(a, b, height);
    const int32_t rho = squareRoot((int64_t(a.top) << 16) / b.top);
    const int32_t d = rootInEdges(a.top) - rootInEdges(height);
    const int32_t lgVoxels = lg(a.voxels);
    if (isFlat_)
      return volumeTerm(b.voxels) - 3 * lgLimited(a, lgVoxels) + 16 * rho +
             6 * contactInPlane(b, faces) - 5 * d + 2 * std::max(0, 1536 - lgVoxels);
    return volumeTerm(b.voxels) - twiceLgLimited(a, lgVoxels) + 18 * rho + 5 * contact(b, faces) -
           8 * d + 3 * std::max(0, 1792 - lgVoxels);
  }

  int32_t volumeTerm(int64_t voxels) const { return (isFlat_ ? 3 : 2) * lg(voxels); }

 private:
  using Wide = unsigned __int128;

  /// Takes tops that are not sure for less (hierarchy.h).
  static void limitDoubtful(ScoredClass& a, ScoredClass& b, int32_t height) {
    if (a.sure < a.top) {
      const auto nearlyAll = int32_t(int64_t(a.top) * 9 / 10);
      a.top = std::max({a.sure, std::min(a.top, b.sure), height, nearlyAll});
    }
    if (b.sure < b.top && b.voxels <= a.voxels) b.top = std::max(a.top, b.sure);
  }

  /// 256 times the length of that square, in shortest edges of a voxel.
  int32_t rootInEdges(int32_t square) const {
    return squareRoot((int64_t(square) << 16) / shortest_);
  }

  /// 2 lg U_a: V_a, but no more than about its largest ball, sqrt(18 m^3), but no less than V_a/4.
  /// 1067 = lg 18. The ball's voxels on unequal ones: sqrt(18 m^3 / (wx wy wz)).
  int32_t twiceLgLimited(const ScoredClass& a, int32_t lgVoxels) const {
    const int32_t ball = 1067 + 3 * lg(std::max(1, a.top / factor_)) - lgProduct_;
    return std::max(2 * lgVoxels - 1024, std::min(2 * lgVoxels, std::max(0, ball)));
  }

  /// 256 F / U_b^(2/3), at most 8191: the largest x with x^3 U_b^2 <= (256 F)^3.
  int32_t contact(const ScoredClass& b, int64_t faces) const {
    const Wide square = Wide(b.voxels) * uint64_t(b.voxels);
    const Wide ball = Wide(18) * uint64_t(b.top) * uint64_t(b.top) * uint64_t(b.top) / product_;
    const Wide limited = std::max(square / 16, std::min(square, std::max(Wide(1), ball)));
    const Wide whole = Wide(faces) * 256, cube = whole * whole * whole;
    uint64_t x = 0;
    for (uint64_t bit = 4096; bit > 0; bit >>= 1) {
      const uint64_t next = x + bit;
      if (next * next * next * limited <= cube) x = next;
    }
    return int32_t(x);
  }

  /// lg U_a: V_a, but no more than about its largest disc, 2.5 m, but no less than V_a / 4.
  /// 338 = lg 2.5. The disc's voxels on unequal ones: 2.5 m / sqrt(wx wy).
  int32_t lgLimited(const ScoredClass& a, int32_t lgVoxels) const {
    const int32_t disc = 338 + lg(std::max(1, a.top / factor_)) - lgProduct_ / 2;
    return std::max(lgVoxels - 512, std::min(lgVoxels, std::max(0, disc)));
  }

  /// 256 F / sqrt(U_b), at most 8191: the largest x with x^2 4 U_b <= (512 F)^2.
  int32_t contactInPlane(const ScoredClass& b, int64_t faces) const {
    const Wide squared = Wide(100) * uint64_t(b.top) * uint64_t(b.top) / product_;
    Wide disc = 0;  // floor(10 m / sqrt(wx wy))
    for (Wide bit = Wide(1) << 35; bit > 0; bit >>= 1)
      if ((disc + bit) * (disc + bit) <= squared) disc += bit;
    const Wide area = uint64_t(b.voxels);
    const Wide limited = std::max(area, std::min(4 * area, std::max(Wide(1), disc)));
    const Wide whole = Wide(faces) * 512;
    uint64_t x = 0;
    for (uint64_t bit = 4096; bit > 0; bit >>= 1) {
      const uint64_t next = x + bit;
      if (next * next * limited <= whole * whole) x = next;
    }
    return int32_t(x);
  }

  bool isFlat_;
  int32_t shortest_ = 0, factor_ = 0;  // of the axes that count
  Wide product_ = 1;
  int32_t lgProduct_ = 0;
};

}  // namespace vdb_madf::detail
