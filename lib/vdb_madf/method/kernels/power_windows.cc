// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/method/kernels/power_windows.h"

#include <algorithm>
#include <limits>

#include "vdb_madf/method/detail/metric.h"
#include "vdb_madf/method/kernels/lanes.h"
#include "vdb_madf/method/kernels/lower_envelope.h"

// Why keys tell powers and ties apart stands in lower_envelope.cc, with M = 2^shift there. A ball
// of D < 2^15 has keys above -2^30 wherever it counts, and what is added to one in reach is below
// 2^30.

namespace vdb_madf::detail {

int keyReach(int32_t largest, int32_t weight) {
  int reach = 0;
  while (squaredAlong(int64_t(reach) + 1, weight) < largest) ++reach;
  return reach;
}

void KeyLines::resize(int stride, int length, int reach) {
  stride_ = stride;
  length_ = length;
  reach_ = reach;
  padding_ = reach + kLanes / 2;  // the last lanes of a line may go on behind it
  pitch_ = size_t((length + 2 * padding_) * stride);
  const auto lines = size_t(64 / stride);
  if (key.size() < lines * pitch_) {
    key.resize(lines * pitch_);
    site.resize(lines * pitch_);
    leastKey.resize(lines * pitch_);
    leastSite.resize(lines * pitch_);
  }
  const auto padding = size_t(padding_ * stride);
  for (size_t line = 0; line < lines; ++line) {
    std::fill_n(key.data() + line * pitch_, padding, 0);
    std::fill_n(key.data() + (line + 1) * pitch_ - padding, padding, 0);
  }
}

namespace {

/// What 16 voxels have found: their least key, and its site.
template <int Bytes>
struct Least {
  Lanes<Bytes> key, site;

  /// Of equal keys that of the smaller position wins: `Before` says whether the others lie before
  /// all that was seen so far, or after it.
  template <bool Before>
  VDB_MADF_INLINE void take(const int32_t* keys, const uint32_t* sites, int32_t added) {
    Lanes<Bytes> otherKey, otherSite;
    otherKey.load(keys);
    otherSite.load(sites);
    for (int i = 0; i < key.kCount; ++i) {
      const auto other = otherKey.v[i] + added;
      site.v[i] = (Before ? other <= key.v[i] : other < key.v[i]) ? otherSite.v[i] : site.v[i];
      key.v[i] = other < key.v[i] ? other : key.v[i];
    }
  }
};

/// The window around 16 voxels grows by one position at either end, k = 1, 2, ... What is further
/// away than k - 1 adds at least 2^shift w k^2 to `least`, the least key of the line, so nothing
/// can win once that is more than the largest of the 16. `unit`: 2^shift w. Voxels that are none of
/// the object have the smallest number, and wait for nothing; those without a site take keys below
/// -2^shift, that is, of negative powers.
template <int Stride, int Bytes>
VDB_MADF_KERNEL Least<Bytes> leastInWindow(const int32_t* key, const uint32_t* site, int shift,
                                           int32_t unit, int reach, int32_t least) {
  constexpr int kTogether = 4;  // steps until the largest is looked for again
  Least<Bytes> found;
  found.key.load(key);
  found.site.load(site);
  for (int i = 0; i < found.key.kCount; ++i) {
    auto& k = found.key.v[i];
    k = k == 0 ? std::numeric_limits<int32_t>::min() : k;
    k = k > 0 ? -(1 << shift) : k;
  }
  for (int k = 1; k <= reach && unit * (k * k) <= found.key.largest() - least;) {
    for (const int end = std::min(k + kTogether, reach + 1); k < end; ++k) {
      const int32_t added = unit * (k * k);
      found.template take<true>(key - k * Stride, site - k * Stride, added);
      found.template take<false>(key + k * Stride, site + k * Stride, added);
    }
  }
  return found;
}

template <int Stride, int Bytes>
VDB_MADF_KERNEL void sweepLine(int line, int shift, int32_t unit, KeyLines& lines) {
  int32_t least = 0;
  const int reach = lines.reach();
  const int32_t* const first = lines.key.data() + lines.at(line, -reach);
  const int32_t* const end = lines.key.data() + lines.at(line, lines.length() + reach);
  for (const int32_t* key = first; key != end; ++key) least = std::min(least, *key);
  if (least == 0) {  // no site, as in many lines after a filter
    std::fill_n(lines.leastKey.data() + lines.at(line, 0), size_t(lines.length() * Stride),
                kNotNegative);
    return;
  }
  for (int t = 0; t < lines.length(); t += kLanes / Stride) {
    const size_t at = lines.at(line, t);
    auto found = leastInWindow<Stride, Bytes>(lines.key.data() + at, lines.site.data() + at, shift,
                                              unit, reach, least);
    for (int i = 0; i < found.key.kCount; ++i)
      found.key.v[i] = found.key.v[i] < -(1 << shift) ? found.key.v[i] : kNotNegative;
    found.key.store(lines.leastKey.data() + at);
    found.site.store(lines.leastSite.data() + at);
  }
}

}  // namespace

void leastKeys(int shift, int32_t weight, KeyLines& lines) {
  const int32_t unit = lines.reach() > 0 ? weight << shift : 0;  // else it may not fit
  atBestLevel([&](auto bytes) VDB_MADF_INLINE {
    for (int line = 0; line < 64 / lines.stride(); ++line) {
      if (lines.stride() == 1)
        sweepLine<1, bytes>(line, shift, unit, lines);
      else
        sweepLine<kLanes, bytes>(line, shift, unit, lines);
    }
  });
}

}  // namespace vdb_madf::detail
