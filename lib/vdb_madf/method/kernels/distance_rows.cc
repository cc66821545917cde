// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/method/kernels/distance_rows.h"

#include <algorithm>
#include <vector>

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

/// The window beyond which a look at each row by itself costs less.
constexpr int kWidest = 256;

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

/// The least value of 16 rows, from row `first` on.
template <int Bytes>
VDB_MADF_KERNEL uint32_t leastOf16(const uint32_t* in, int length, int first) {
  Lanes<Bytes, uint32_t> least, value;
  least.load(in + first);
  for (int t = 1; t < length; ++t) {
    value.load(in + t * 64 + first);
    for (int i = 0; i < least.kCount; ++i)
      least.v[i] = value.v[i] < least.v[i] ? value.v[i] : least.v[i];
  }
  for (auto& v : least.v) v = ~v;
  return ~least.largest();
}

// The window around t grows by one position at either end, k = 1, 2, ...: after step k
//   best = min over |s - t| <= k of in(s) + w (s - t)^2,  w = weight.
// What is further away than k - 1 adds at least w k^2 to in >= least, so nothing can gain once
//   w k^2 + least >= best
// in all lanes, nor anything of w reach^2 or less after k = reach. Where `least`, of the positions
// without the padding, is above 0, as it is in rows with no background in them, the padding is
// looked at before. Beyond an end of the row the padding there is looked at again, from further
// away than before, which changes nothing: so the nearer end needs no loop of its own.
//
// False if a window would be wider than kWidest: then `out` is not complete.
template <int Bytes, typename Weight>
VDB_MADF_KERNEL bool widen(const uint32_t* in, const uint32_t* leastOfRows, int length, int begin,
                           int end, Weight weight, int reach, uint32_t* out) {
  constexpr int kTogether = 2;  // steps until the largest is looked for again
  for (int t = begin; t < end; ++t) {
    const int toBegin = t + 1, toEnd = length - t;  // distances of the padding
    const int last = std::min(reach, std::max(toBegin, toEnd));
    for (int lane = 0; lane < 64; lane += kLanes) {
      const uint32_t* const center = in + t * 64 + lane;
      const uint32_t least = leastOfRows[lane / kLanes];
      Lanes<Bytes, uint32_t> best, below, above;
      best.load(center);
      if (least > 0) {
        below.load(in - 64 + lane);
        above.load(in + length * 64 + lane);
        for (int i = 0; i < best.kCount; ++i) {
          const auto before = below.v[i] + squaredAlong(uint32_t(toBegin), weight);
          const auto after = above.v[i] + squaredAlong(uint32_t(toEnd), weight);
          const auto nearer = before < after ? before : after;
          best.v[i] = nearer < best.v[i] ? nearer : best.v[i];
        }
      }
      for (int k = 1; k <= last && squaredAlong(uint32_t(k), weight) + least < best.largest();) {
        if (k > kWidest) return false;
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
  return true;
}

/// What a position of a row offers to the others, and from which one on it is the best.
struct RowPart {
  int64_t value;
  int place, from;
};

/// The same of one row, by the lower envelope of what its positions offer: in time that goes with
/// its length, however wide the windows are. A later position s gains on an earlier one p where
///   2 w t (s - p) > in(s) - in(p) + w (s^2 - p^2).
void widenFar(const uint32_t* in, int length, int begin, int end, int64_t weight,
              std::vector<RowPart>& lowest, uint32_t* out) {
  lowest.clear();
  for (int s = -1; s <= length; ++s) {
    const int64_t value = in[s * 64];
    if (value >= kInfinite) continue;
    int64_t from = begin;  // where none is left that was lower before
    for (; !lowest.empty(); lowest.pop_back()) {
      const RowPart& p = lowest.back();
      const int64_t over = value - p.value + weight * (s - p.place) * (s + p.place);
      const int64_t slope = 2 * weight * (s - p.place);
      if (over >= slope * p.from) {
        from = over / slope + 1;
        break;
      }
    }
    if (from < end) lowest.push_back({value, s, int(from)});
  }
  for (int t = begin; lowest.empty() && t < end; ++t) out[t * 64] = kInfinite;
  for (size_t i = 0; i < lowest.size(); ++i) {
    const int stop = i + 1 < lowest.size() ? lowest[i + 1].from : end;
    for (int64_t t = lowest[i].from; t < stop; ++t) {
      const int64_t away = t - lowest[i].place;
      out[t * 64] = uint32_t(std::min<int64_t>(lowest[i].value + weight * away * away, kInfinite));
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

LeastOfRows leastOfRows(const uint32_t* in, int length) {
  LeastOfRows least;
  static_assert(least.size() * kLanes == 64);
  atBestLevel([&](auto bytes) VDB_MADF_INLINE {
    for (size_t i = 0; i < least.size(); ++i)
      least[i] = leastOf16<bytes>(in, length, int(i) * kLanes);
  });
  return least;
}

void widenWindows(const uint32_t* in, const LeastOfRows& least, int length, int begin, int end,
                  int32_t weight, int reach, uint32_t* out) {
  const bool isDone = atBestLevel([&](auto bytes) VDB_MADF_INLINE {
    const uint32_t* const of = least.data();
    return weight == 1 ? widen<bytes>(in, of, length, begin, end, UnitWeight(), reach, out)
                       : widen<bytes>(in, of, length, begin, end, weight, reach, out);
  });
  std::vector<RowPart> lowest;
  for (int row = 0; row < 64 && !isDone; ++row)
    widenFar(in + row, length, begin, end, weight, lowest, out + row);
}

}  // namespace vdb_madf::detail
