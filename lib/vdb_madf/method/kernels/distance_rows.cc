// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/method/kernels/distance_rows.h"

#include <algorithm>

#include "vdb_madf/base/detail/simd.h"
#include "vdb_madf/base/limits.h"
#include "vdb_madf/method/detail/metric.h"
#include "vdb_madf/method/kernels/lanes.h"

namespace vdb_madf::detail {

namespace {

/// kInfinite for the linear distances of the first pass: more than any row is long, and the least
/// whose square does not fit.
constexpr uint32_t kFar = 46341;
static_assert(kFar > kMaxExtent + 8 && uint64_t(kFar) * kFar > kInfinite);

/// Of 16 of the 64 rows, from row `first` on.
template <int Bytes, typename Weight>
VDB_MADF_KERNEL void scan(const uint64_t* masks, int length, const RowDomain& domain, int first,
                          Weight weight, uint32_t* out) {
  using Numbers = Lanes<Bytes, uint32_t>;
  Numbers state, inside;
  // One more than the state before, but at voxels outside the object: 0, or kFar if not in the
  // domain.
  const auto advance = [&](int t) VDB_MADF_INLINE {
    inside.fillFromBits(uint32_t(masks[t] >> first & 0xffff));
    const uint32_t outside = t >= domain.begin && t < domain.end ? 0 : kFar;
    for (int i = 0; i < state.kCount; ++i)
      state.v[i] = ((state.v[i] + 1) & inside.v[i]) | (outside & ~inside.v[i]);
  };
  const auto begin = [&](const std::array<uint32_t, 64>& beyond) VDB_MADF_INLINE {
    state.load(beyond.data() + first);
    for (auto& v : state.v) v = v < kFar ? v : kFar;
  };
  begin(domain.before);
  for (int t = 0; t < length; ++t) {
    advance(t);
    state.store(out + t * 64 + first);
  }
  begin(domain.after);
  for (int t = length - 1; t >= 0; --t) {
    advance(t);
    Numbers nearest;
    nearest.load(out + t * 64 + first);
    for (int i = 0; i < state.kCount; ++i) {
      auto& v = nearest.v[i];
      v = v < state.v[i] ? v : state.v[i];
      v = v < kFar ? v * v * uint32_t(weight) : kInfinite;
    }
    nearest.store(out + t * 64 + first);
  }
}

// The window around t grows by one position at either end, k = 1, 2, ...: after step k
//   best = min over |s - t| <= k of in(s) + w (s - t)^2,  w = weight.
// What is further away than k - 1 adds at least w k^2 to in >= 0, so nothing can gain once
//   w k^2 >= best
// in all lanes, nor anything of w reach^2 or less after k = reach. Beyond an end of the row the
// padding there is looked at again, from further away than before, which changes nothing: so the
// nearer end needs no loop of its own.
template <int Bytes, typename Weight>
VDB_MADF_KERNEL void widen(const uint32_t* in, int length, int begin, int end, Weight weight,
                           int reach, uint32_t* out) {
  constexpr int kTogether = 2;  // steps until the largest is looked for again
  for (int t = begin; t < end; ++t) {
    const int toBegin = t + 1, toEnd = length - t;  // distances of the padding
    const int last = std::min(reach, std::max(toBegin, toEnd));
    for (int lane = 0; lane < 64; lane += kLanes) {
      const uint32_t* center = in + t * 64 + lane;
      Lanes<Bytes, uint32_t> best, below, above;
      best.load(center);
      for (int k = 1; k <= last && squaredAlong(uint32_t(k), weight) < best.largest();) {
        for (const int stop = std::min(k + kTogether, last + 1); k < stop; ++k) {
          const uint32_t k2 = squaredAlong(uint32_t(k), weight);
          below.load(center - std::min(k, toBegin) * 64);
          above.load(center + std::min(k, toEnd) * 64);
          for (int i = 0; i < best.kCount; ++i) {
            const auto nearer = (below.v[i] < above.v[i] ? below.v[i] : above.v[i]) + k2;
            best.v[i] = nearer < best.v[i] ? nearer : best.v[i];
          }
        }
      }
      for (auto& v : best.v) v = v < kInfinite ? v : kInfinite;
      best.store(out + t * 64 + lane);
    }
  }
}

}  // namespace

void scanRows(const uint64_t* masks, int length, const RowDomain& domain, int32_t weight,
              uint32_t* out) {
  atBestLevel([&](auto bytes) VDB_MADF_INLINE {
    for (int first = 0; first < 64; first += kLanes) {
      if (weight == 1)
        scan<bytes>(masks, length, domain, first, UnitWeight(), out);
      else
        scan<bytes>(masks, length, domain, first, weight, out);
    }
  });
}

void widenWindows(const uint32_t* in, int length, int begin, int end, int32_t weight, int reach,
                  uint32_t* out) {
  atBestLevel([&](auto bytes) VDB_MADF_INLINE {
    if (weight == 1)
      widen<bytes>(in, length, begin, end, UnitWeight(), reach, out);
    else
      widen<bytes>(in, length, begin, end, weight, reach, out);
  });
}

}  // namespace vdb_madf::detail
