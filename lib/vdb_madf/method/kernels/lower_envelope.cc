// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/method/kernels/lower_envelope.h"

#include <algorithm>

#include "vdb_madf/base/detail/simd.h"
#include "vdb_madf/method/detail/metric.h"

// The order of parabolas at u, f(u) = power + w (u - x)^2, x = position, w = weight of the axis,
// with the rule of ties put into one number:
//   key(u) = M f(u) - D,  M > max D.
// D is in 1 .. M - 1, so
//   f_a(u) < f_b(u)  =>  key_a(u) <= M f_b(u) - M - D_a < M f_b(u) - D_b = key_b(u),
//   f_a(u) = f_b(u)  =>  key_a(u) < key_b(u) <=> D_a > D_b;
// comparing keys compares f, then prefers the larger D. At equal keys the earlier position wins
// (the order z, y, x of the passes makes that the lexicographic order). Expanded,
//   key(u) = M w u^2 - 2 M w x u + k,  k = M height - D,  height = power + w x^2:
// M w u^2 is common to all, so only the lines k - 2 M w x u are compared. k is Parabola::key.
//
// The weight is a type here: UnitWeight where it is 1, else a number.

namespace vdb_madf::detail {

template <typename Key>
void EnvelopeRows<Key>::resize(size_t length) {
  if (starting.size() <= length) {
    power.resize((length + 2) * kEnvelopeSlab);
    site.resize(length * kEnvelopeSlab);
    radius2.resize((length + 2) * kEnvelopeSlab);
    object.resize((length + 63) / 64 * 64);
    candidate.resize((length + 63) / 64 * 64);
    envelope.resize(std::max(envelope.size(), length));
    starting.resize(length + 1);
  }
  std::fill_n(power.data() + (length + 1) * kEnvelopeSlab, kEnvelopeSlab, 0);
  words = (length + 63) / 64;
  for (size_t row = 0; row < 64; ++row)
    object[row * words + words - 1] = candidate[row * words + words - 1] = 0;
}

template struct EnvelopeRows<int64_t>;
template struct EnvelopeRows<__int128>;

namespace {

/// Marks object voxels and candidates. Let a, b, c be the parabolas of the positions t - 1, t, t +
/// 1. At every u
///   f_a(u) + f_c(u) - 2 f_b(u) = p_a + p_c - 2 p_b + 2 w =: bend,
/// so b is
///   bend < 0:  least nowhere, for a or c is less;
///   bend = 0:  least only where all three are equal, and it wins that tie only if D_b > D_a and
///              D_b >= D_c, which needs 2 D_b - D_a - D_c =: radiusBend > 0;
///   bend > 0:  a candidate. So it is where a or c is no site.
/// Whatever is left out has a better one wherever it is below 0, so the best one of a voxel is
/// never left out, nor are its parabolas in the passes before.
template <typename Key, typename Weight>
VDB_MADF_KERNEL void markCandidates(size_t length, Weight weight, EnvelopeRows<Key>& s) {
  constexpr bool kFilter = sizeof(Key) == 8;  // wide keys: what follows could overflow
  for (size_t i = 0; i < length / 8; ++i) {
    uint8_t object[8][64], candidate[8][64];
    for (size_t t = 0; t < 8; ++t) {
      const int32_t* p = s.power.data() + (i * 8 + t + 1) * kEnvelopeSlab;
      const int32_t* d = s.radius2.data() + (i * 8 + t + 1) * kEnvelopeSlab;
      for (size_t row = 0; row < 64; ++row) {
        const int32_t power = p[row], before = p[row - kEnvelopeSlab],
                      after = p[row + kEnvelopeSlab];
        // Unsigned, so that it wraps where nothing depends on it: beside voxels that are no sites.
        const auto bend = int32_t(uint32_t(before) + uint32_t(after) - 2 * uint32_t(power) +
                                  2 * uint32_t(weight));
        const auto radiusBend = int32_t(2 * uint32_t(d[row]) - uint32_t(d[row - kEnvelopeSlab]) -
                                        uint32_t(d[row + kEnvelopeSlab]));
        const bool below =
            !kFilter | (bend > 0) | ((bend == 0) & (radiusBend > 0)) | (before >= 0) | (after >= 0);
        object[t][row] = power != 0;
        candidate[t][row] = (power < 0) & below;
      }
    }
    for (size_t row = 0; row < 64; ++row) {
      uint64_t objectBits = 0, candidateBits = 0;
      for (size_t t = 0; t < 8; ++t) {
        objectBits |= uint64_t(object[t][row]) << t;
        candidateBits |= uint64_t(candidate[t][row]) << t;
      }
      const size_t word = row * s.words + i / 8, shift = i % 8 * 8;
      s.object[word] = (shift ? s.object[word] : 0) | objectBits << shift;
      s.candidate[word] = (shift ? s.candidate[word] : 0) | candidateBits << shift;
    }
  }
}

/// Bits [begin, end) of the 64 from `first` on.
inline uint64_t bitsBetween(int first, int begin, int end) {
  const uint64_t from = begin > first ? ~uint64_t(0) << (begin - first) : ~uint64_t(0);
  const uint64_t to = end - first < 64 ? (uint64_t(1) << (end - first)) - 1 : ~uint64_t(0);
  return from & to;
}

/// The envelope of the candidates in [begin, end) of a row, and of what is `before` and `after`
/// that, in s.envelope. Returns their number.
///
/// In the order of keys, c less than b means, with x = position,
///   key_c(u) < key_b(u)  <=>  k_c - 2 M w x_c u < k_b - 2 M w x_b u
///                        <=>  u > (k_c - k_b) / (2 M w (x_c - x_b))  =: u_bc.
/// So b, between a and c, is least for u_ab < u <= u_bc, and it stays if
///   u_ab < u_bc  <=>  (k_b - k_a) / (x_b - x_a) < (k_c - k_b) / (x_c - x_b)
///                <=>  (k_b - k_a) (x_c - x_b) < (k_c - k_b) (x_b - x_a).
/// Else it goes when c comes: the points (x, k) of what stays are a lower convex hull.
template <bool Beyond, typename Key, typename Weight>
[[gnu::always_inline]] inline int buildEnvelope(EnvelopeRows<Key>& s, size_t row, int begin,
                                                int end, bool isLast, Key multiplier,
                                                Weight weight) {
  Parabola<Key>* const first = s.envelope.data();
  Parabola<Key>* next = first;
  const auto push = [&](int position, int32_t power, int32_t radius2, uint32_t site) {
    const int32_t height = power + squaredAlong(position, weight);
    const Key key = height * multiplier - radius2;
    for (; next - first > 1; --next) {
      const Parabola<Key>&a = next[-2], &b = next[-1];
      if ((b.key - a.key) * (position - b.position) < (key - b.key) * (b.position - a.position))
        break;
    }
    *next++ = {key, height, radius2, position, site};
  };
  const auto pushBeyond = [&](const BeyondRows& rows) {
    for (uint32_t i = rows.first[row]; i < rows.first[row + 1]; ++i)
      push(rows.sites[i].position - begin, -rows.sites[i].radius2, rows.sites[i].radius2,
           rows.sites[i].site);
  };
  if (Beyond && begin == 0) pushBeyond(s.before);
  const int32_t* powers = s.power.data() + kEnvelopeSlab + row;
  const int32_t* radii = s.radius2.data() + kEnvelopeSlab + row;
  const uint32_t* sites = s.site.data() + row;
  for (int base = begin & ~63; base < end; base += 64) {
    uint64_t bits = s.candidate[row * s.words + size_t(base) / 64] & bitsBetween(base, begin, end);
    for (; bits; bits &= bits - 1) {
      const int t = base + __builtin_ctzll(bits);
      const size_t at = size_t(t) * kEnvelopeSlab;
      push(t - begin, powers[at], radii[at], sites[at]);
    }
  }
  if (Beyond && isLast) pushBeyond(s.after);
  return int(next - first);
}

/// The pass over one run [begin, end) of a row's object voxels, in place. Positions u count from
/// `begin`.
///
/// Of two neighbors a, b on the envelope, b is less than a from its start on:
///   f_b(u) - f_a(u) = rise - u twice,  rise = height_b - height_a,  twice = 2 w (x_b - x_a) > 0,
///   key_b(u) < key_a(u)  <=>  u twice > rise,  or  u twice = rise and D_b > D_a,
///   start = 0                       if rise < 0,
///           floor(rise / twice)     if twice divides rise and D_b > D_a,
///           floor(rise / twice) + 1 else.
/// The quotient of integers this small is exact enough in double precision for its floor to be that
/// of the integer division.
template <bool Beyond, typename Key, typename Weight>
[[gnu::always_inline]] inline void sweepRun(EnvelopeRows<Key>& s, size_t row, int begin, int end,
                                            bool isLast, Key multiplier, Weight weight) {
  const int length = end - begin;
  const int count = buildEnvelope<Beyond>(s, row, begin, end, isLast, multiplier, weight);
  int32_t* power = s.power.data() + size_t(begin + 1) * kEnvelopeSlab + row;
  uint32_t* site = s.site.data() + size_t(begin) * kEnvelopeSlab + row;
  if (count == 0) {
    for (int u = 0; u < length; ++u) power[size_t(u) * kEnvelopeSlab] = kNotNegative;
    return;
  }
  uint32_t* starting = s.starting.data();
  for (int i = 1; i < count; ++i) {
    const Parabola<Key>&a = s.envelope[size_t(i) - 1], &b = s.envelope[size_t(i)];
    const int64_t rise = int64_t(b.height) - a.height,
                  twice = 2 * weight * int64_t(b.position - a.position);
    const int64_t quotient = int64_t(double(rise) / double(twice));
    const bool winsTie = (quotient * twice == rise) & (b.radius2 > a.radius2);
    const int64_t start = rise < 0 ? 0 : quotient + !winsTie;
    ++starting[std::min<int64_t>(start, length)];
  }
  starting[length] = 0;
  const Parabola<Key>* least = s.envelope.data();
  for (int u = 0; u < length; ++u) {
    least += starting[u];
    starting[u] = 0;
    // power + w (u - x)^2
    const int32_t value = least->height + weight * (u * (u - 2 * least->position));
    power[size_t(u) * kEnvelopeSlab] = value < 0 ? value : kNotNegative;
    site[size_t(u) * kEnvelopeSlab] = least->site;
  }
}

/// First position from t on that is (invert = 0) or is not (all ones) an object voxel of the row.
template <typename Key>
[[gnu::always_inline]] inline int findObject(const EnvelopeRows<Key>& s, size_t row, int t,
                                             int length, uint64_t invert) {
  uint64_t bits = (s.object[row * s.words + size_t(t) / 64] ^ invert) & ~uint64_t(0) << (t & 63);
  for (t &= ~63; !bits;) {
    t += 64;
    if (t >= length) return length;
    bits = s.object[row * s.words + size_t(t) / 64] ^ invert;
  }
  return std::min(length, t + __builtin_ctzll(bits));
}

/// All runs of all rows.
template <bool Beyond, typename Key, typename Weight>
VDB_MADF_KERNEL void sweepRows(int length, Key multiplier, Weight weight, EnvelopeRows<Key>& s) {
  for (size_t row = 0; row < 64; ++row) {
    for (int end = 0; end < length;) {
      const int begin = findObject(s, row, end, length, 0);
      if (begin == length) break;
      end = findObject(s, row, begin, length, ~uint64_t(0));
      sweepRun<Beyond>(s, row, begin, end, end == length, multiplier, weight);
    }
  }
}

}  // namespace

template <typename Key>
void lowerEnvelopes(int length, Key multiplier, int32_t axisWeight, EnvelopeRows<Key>& rows) {
  const auto sweep = [&](auto weight) {
    atBestLevel([&]() VDB_MADF_INLINE { markCandidates(size_t(length), weight, rows); });
    const size_t beyond = rows.before.sites.size() + rows.after.sites.size();
    if (beyond == 0) {
      atBestLevel([&]() VDB_MADF_INLINE { sweepRows<false>(length, multiplier, weight, rows); });
      return;
    }
    if (rows.envelope.size() < size_t(length) + beyond)
      rows.envelope.resize(size_t(length) + beyond);
    atBestLevel([&]() VDB_MADF_INLINE { sweepRows<true>(length, multiplier, weight, rows); });
  };
  if (axisWeight == 1)
    sweep(UnitWeight());
  else
    sweep(axisWeight);
}

template void lowerEnvelopes(int, int64_t, int32_t, EnvelopeRows<int64_t>&);
template void lowerEnvelopes(int, __int128, int32_t, EnvelopeRows<__int128>&);

}  // namespace vdb_madf::detail
