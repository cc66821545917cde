// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <array>
#include <cstdint>

// The passes of the squared distance along 64 rows at a time, on plain arrays. A slab holds the
// values of the 64 rows at one position; slab follows slab.

namespace vdb_madf::detail {

/// The distance where no background voxel is known yet. Adding the square of a row's length to it
/// does not overflow 32 bits.
constexpr uint32_t kInfinite = 1u << 31;

// `weight` is that of the axis (voxel_weights.h); weight * length^2 must be less than 2^31.

/// The positions of rows that lie in the domain (all, where the boundary is closed), and what the
/// positions of each row just before the first and just after the last count as.
struct RowDomain {
  int begin, end;  ///< positions [begin, end) lie in the domain
  /// 0: background; kInfinite: unknown; in the first pass also n: the nearest background is n more
  /// steps away.
  std::array<uint32_t, 64> before, after{};
};

/// First pass: out(t) = the squared distance along the row to the nearest background voxel, or
/// kInfinite if there is none. Bit `row` of masks[t] tells whether a voxel is in the object; voxels
/// outside the object and the domain are unknown, not background.
/// `out` holds `length` slabs.
void scanRows(const uint64_t* masks, int length, const RowDomain& domain, int32_t weight,
              uint32_t* out);

/// The least value of each group of 16 rows, at the positions [0, length).
using LeastOfRows = std::array<uint32_t, 4>;
LeastOfRows leastOfRows(const uint32_t* in, int length);

/// Other passes, at the positions t in [begin, end): out(t) = min over s of in(s) + weight (s -
/// t)^2, at most kInfinite; where that is more than weight * reach^2, anything more. `in` and `out`
/// point to the slab of position 0; `in` has `length` slabs and one more at either end, the
/// positions -1 and `length`. `least` is leastOfRows(in, length).
void widenWindows(const uint32_t* in, const LeastOfRows& least, int length, int begin, int end,
                  int32_t weight, int reach, uint32_t* out);

}  // namespace vdb_madf::detail
