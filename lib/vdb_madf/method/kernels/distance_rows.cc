// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/method/kernels/distance_rows.h"

#include <algorithm>

#include "vdb_madf/base/detail/simd.h"
#include "vdb_madf/base/limits.h"
#include "vdb_madf/method/detail/metric.h"

namespace vdb_madf::detail {

namespace {

/// kInfinite for the linear distances of the first pass: more than any row is long, and the least
/// whose square does not fit.
constexpr uint32_t kFar = 46341;
static_assert(kFar > kMaxExtent + 8 && uint64_t(kFar) * kFar > kInfinite);

/// Lanes that stop their search for a nearer background voxel together.
constexpr int kLanes = 16;

template <typename Weight>
VDB_MADF_KERNEL void scan(const uint64_t* masks, int length, const RowDomain& domain, Weight weight,
                          uint32_t* out) {
  uint32_t state[64];
  const auto advance = [&](int t, uint32_t* slab, bool forward) {
    const uint64_t word = masks[t];
    const uint32_t outside = t >= domain.begin && t < domain.end ? 0 : kFar;
    for (int row = 0; row < 64; ++row) {
      const uint32_t inside = 0u - uint32_t(word >> row & 1);
      state[row] = ((state[row] + 1) & inside) | (outside & ~inside);
      slab[row] = forward ? state[row] : std::min(slab[row], state[row]);
    }
  };
  for (size_t row = 0; row < 64; ++row) state[row] = std::min(domain.before[row], kFar);
  for (int t = 0; t < length; ++t) advance(t, out + t * 64, true);
  for (size_t row = 0; row < 64; ++row) state[row] = std::min(domain.after[row], kFar);
  for (int t = length - 1; t >= 0; --t) {
    uint32_t* slab = out + t * 64;
    advance(t, slab, false);
    for (int row = 0; row < 64; ++row)
      slab[row] = slab[row] >= kFar ? kInfinite : squaredAlong(slab[row], weight);
  }
}

// The window around t grows by one position at either end, k = 1, 2, ...: after step k
//   best = min over |s - t| <= k of in(s) + w (s - t)^2,  w = weight.
// What is further away than k - 1 adds at least w k^2 to in >= 0, so nothing can gain once
//   w k^2 >= best
// in all lanes, nor anything of w reach^2 or less after k = reach. Beyond an end of the row the
// padding there is looked at again, from further away than before, which changes nothing: so the
// nearer end needs no loop of its own.
VDB_MADF_KERNEL void widen(const uint32_t* in, int length, int begin, int end, int32_t weight,
                           int reach, uint32_t* out) {
  for (int t = begin; t < end; ++t) {
    const int toBegin = t + 1, toEnd = length - t;  // distances of the padding
    const int last = std::min(reach, std::max(toBegin, toEnd));
    for (int lane = 0; lane < 64; lane += kLanes) {
      const uint32_t* center = in + t * 64 + lane;
      uint32_t best[kLanes];
      uint32_t worst = 0;
      for (int i = 0; i < kLanes; ++i) {
        best[i] = center[i];
        worst = std::max(worst, best[i]);
      }
      for (int k = 1; k <= last && squaredAlong(uint32_t(k), weight) < worst; ++k) {
        const uint32_t k2 = squaredAlong(uint32_t(k), weight);
        const uint32_t* below = center - std::min(k, toBegin) * 64;
        const uint32_t* above = center + std::min(k, toEnd) * 64;
        worst = 0;
        for (int i = 0; i < kLanes; ++i) {
          best[i] = std::min(best[i], std::min(below[i], above[i]) + k2);
          worst = std::max(worst, best[i]);
        }
      }
      for (int i = 0; i < kLanes; ++i) out[t * 64 + lane + i] = std::min(best[i], kInfinite);
    }
  }
}

}  // namespace

void scanRows(const uint64_t* masks, int length, const RowDomain& domain, int32_t weight,
              uint32_t* out) {
  atBestLevel([&]() VDB_MADF_INLINE {
    if (weight == 1)
      scan(masks, length, domain, UnitWeight(), out);
    else
      scan(masks, length, domain, weight, out);
  });
}

void widenWindows(const uint32_t* in, int length, int begin, int end, int32_t weight, int reach,
                  uint32_t* out) {
  atBestLevel([&]() VDB_MADF_INLINE { widen(in, length, begin, end, weight, reach, out); });
}

}  // namespace vdb_madf::detail
