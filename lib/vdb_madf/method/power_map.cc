// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/method/power_map.h"

#include <algorithm>
#include <utility>

#include "vdb_madf/base/detail/simd.h"
#include "vdb_madf/leaves/detail/leaf_values.h"
#include "vdb_madf/leaves/detail/pencil.h"
#include "vdb_madf/method/detail/metric.h"
#include "vdb_madf/method/detail/power_passes.h"

namespace vdb_madf {

namespace {

/// A parabola u -> (u - position)^2 + power of a lower envelope, with the order of ties put into
/// one number: its key (u - position)^2 M + power M - D, M > every D, is less where the power is
/// less or, at equal power, where D is larger. The envelope is then the lower convex hull of the
/// points (position, key + position^2 M), here held without the u^2 M that all have in common.
template <typename Key>
struct Parabola {
  Key key;          // (power + position^2) M - D
  int32_t height;   // power + position^2
  int32_t radius2;  // D
  int32_t position;
  VoxelId site;
};

/// A slab holds the values of a pencil's 64 rows at one position; the padding keeps the positions
/// of a row off the same cache sets.
constexpr size_t kSlab = 64 + 16;

/// A pencil laid out with the swept axis slow: slab after slab, 0 outside the object.
template <typename Key>
struct Scratch {
  std::vector<uint32_t> leaves;
  std::vector<int32_t> power;  // one slab of padding at either end
  std::vector<VoxelId> site;
  std::vector<int32_t> radius2;  // D of the site; one slab of padding at either end
  // A bit per position, row after row: is there an object voxel, can its parabola be part of an
  // envelope? Words of 64 positions; what is beyond the pencil is 0.
  std::vector<uint64_t> object, candidate;
  size_t words = 0;  // per row
  std::vector<Parabola<Key>> envelope;
  std::vector<uint32_t> starting;  // parabolas that become the least one at a position

  /// Never shrinks: growing again would clear what is overwritten anyway.
  void resize(size_t length) {
    if (envelope.size() < length) {
      power.resize((length + 2) * kSlab);
      site.resize(length * kSlab);
      radius2.resize((length + 2) * kSlab);
      object.resize((length + 63) / 64 * 64);
      candidate.resize((length + 63) / 64 * 64);
      envelope.resize(length);
      starting.resize(length + 1);
    }
    std::fill_n(power.data() + (length + 1) * kSlab, kSlab, 0);
    words = (length + 63) / 64;
    for (size_t row = 0; row < 64; ++row)
      object[row * words + words - 1] = candidate[row * words + words - 1] = 0;
  }
};

template <int Axis, typename Key>
VDB_MADF_SIMD void gather(const LeafIndex& index, const PowerMap& map, Scratch<Key>& s) {
  int32_t power[512];
  VoxelId site[512];
  for (size_t i = 0; i < s.leaves.size(); ++i) {
    const uint32_t leaf = s.leaves[i];
    detail::expandLeaf(index.mask(leaf), map.power.data() + index.firstRank(leaf), power);
    detail::copyToSlabs<Axis>(power, kSlab, s.power.data() + (i * 8 + 1) * kSlab);
    if (Axis == 2)  // before the first pass every voxel is its own site
      for (uint32_t k = 0; k < 512; ++k) site[k] = leaf * 512 + k;
    else
      detail::expandLeaf(index.mask(leaf), map.site.data() + index.firstRank(leaf), site);
    detail::copyToSlabs<Axis>(site, kSlab, s.site.data() + i * 8 * kSlab);
  }
}

template <int Axis, typename Key>
VDB_MADF_SIMD void scatter(const LeafIndex& index, const Scratch<Key>& s, PowerMap& map) {
  int32_t power[512];
  VoxelId site[512];
  for (size_t i = 0; i < s.leaves.size(); ++i) {
    const uint32_t leaf = s.leaves[i];
    detail::copyFromSlabs<Axis>(s.power.data() + (i * 8 + 1) * kSlab, kSlab, power);
    detail::copyFromSlabs<Axis>(s.site.data() + i * 8 * kSlab, kSlab, site);
    detail::packLeaf(index.mask(leaf), power, map.power.data() + index.firstRank(leaf));
    detail::packLeaf(index.mask(leaf), site, map.site.data() + index.firstRank(leaf));
  }
}

/// D of all sites, from their partial power: the passes before this one have moved away from the
/// site along z, then y. `origin` is that of the pencil's first leaf.
template <int Axis, typename Key>
VDB_MADF_SIMD void computeRadii(const LeafIndex& index, const Coord& origin, Scratch<Key>& s) {
  const Coord* origins = &index.origin(0);
  for (size_t t = 0; t < s.leaves.size() * 8; ++t) {
    const int32_t* power = s.power.data() + (t + 1) * kSlab;
    const VoxelId* site = s.site.data() + t * kSlab;
    int32_t* radius2 = s.radius2.data() + (t + 1) * kSlab;
    for (int row = 0; row < 64; ++row) {
      int32_t away = 0;
      if (Axis != 2) {  // rows: x*8 + z along y, y*8 + z along x
        const Coord& leaf = origins[leafOf(site[row])];
        const int dz = leaf.z() + int(site[row] & 7) - (origin.z() + (row & 7));
        const int dy = leaf.y() + int(bitOf(site[row]) >> 3) - (origin.y() + (row >> 3));
        away = detail::squaredAlong(dz) + (Axis == 0 ? detail::squaredAlong(dy) : 0);
      }
      radius2[row] = away - power[row];
    }
  }
}

/// Marks object voxels and candidates: sites whose parabola is below the chord over it between its
/// two neighbours (or has a neighbour that is no site). Others are least nowhere. Where the chord
/// goes right through it, the keys differ by D alone.
template <typename Key>
VDB_MADF_SIMD void markCandidates(Scratch<Key>& s) {
  constexpr bool kFilter = sizeof(Key) == 8;  // wide keys: what follows could overflow
  for (size_t i = 0; i < s.leaves.size(); ++i) {
    uint8_t object[8][64], candidate[8][64];
    for (size_t t = 0; t < 8; ++t) {
      const int32_t* p = s.power.data() + (i * 8 + t + 1) * kSlab;
      const int32_t* d = s.radius2.data() + (i * 8 + t + 1) * kSlab;
      for (size_t row = 0; row < 64; ++row) {
        const int32_t power = p[row], before = p[row - kSlab], after = p[row + kSlab];
        // Unsigned, so that it wraps where nothing depends on it: beside voxels that are no sites.
        const auto bend = int32_t(uint32_t(before) + uint32_t(after) - 2 * uint32_t(power) + 2);
        const auto radiusBend =
            int32_t(2 * uint32_t(d[row]) - uint32_t(d[row - kSlab]) - uint32_t(d[row + kSlab]));
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

/// The parabolas of candidates in [begin, end) of a row that are the least somewhere. Returns their
/// number. At equal key the earlier one wins (the order z, y, x of the passes makes that the
/// lexicographic order): on a straight line only the ends count.
template <typename Key>
[[gnu::always_inline]] inline int buildEnvelope(Scratch<Key>& s, size_t row, int begin, int end,
                                                Key multiplier) {
  Parabola<Key>* const first = s.envelope.data();
  Parabola<Key>* next = first;
  const int32_t* powers = s.power.data() + kSlab + row;
  const int32_t* radii = s.radius2.data() + kSlab + row;
  const VoxelId* sites = s.site.data() + row;
  for (int base = begin & ~63; base < end; base += 64) {
    uint64_t bits = s.candidate[row * s.words + size_t(base) / 64] & bitsBetween(base, begin, end);
    for (; bits; bits &= bits - 1) {
      const int t = base + __builtin_ctzll(bits);
      const size_t at = size_t(t) * kSlab;
      const int32_t height = powers[at] + detail::squaredAlong(t - begin);
      const Key key = height * multiplier - radii[at];
      for (; next - first > 1; --next) {
        const Parabola<Key>&b = next[-1], &a = next[-2];
        if ((b.key - a.key) * (t - begin - b.position) < (key - b.key) * (b.position - a.position))
          break;
      }
      *next++ = {key, height, radii[at], t - begin, sites[at]};
    }
  }
  return int(next - first);
}

/// Lower envelope over one run [begin, end) of a row's object voxels, in place. Ties: larger D,
/// then the smaller position. All is uncovered where there is no site.
template <typename Key>
[[gnu::always_inline]] inline void sweepRun(Scratch<Key>& s, size_t row, int begin, int end,
                                            Key multiplier) {
  const int length = end - begin;
  const int count = buildEnvelope(s, row, begin, end, multiplier);
  int32_t* power = s.power.data() + size_t(begin + 1) * kSlab + row;
  VoxelId* site = s.site.data() + size_t(begin) * kSlab + row;
  if (count == 0) {
    for (int u = 0; u < length; ++u) power[size_t(u) * kSlab] = kUncovered;
    return;
  }
  uint32_t* starting = s.starting.data();
  for (int i = 1; i < count; ++i) {
    // Less than the one before at u  <=>  rise < 2 u run. The quotient of such small integers is
    // exact enough in double precision for its floor to be that of the integer division.
    const Parabola<Key>&a = s.envelope[size_t(i) - 1], &b = s.envelope[size_t(i)];
    const int64_t rise = int64_t(b.height) - a.height, twice = 2 * int64_t(b.position - a.position);
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
    const int32_t value = least->height + u * (u - 2 * least->position);
    power[size_t(u) * kSlab] = value < 0 ? value : kUncovered;
    site[size_t(u) * kSlab] = least->site;
  }
}

/// First position from t on that is (invert = 0) or is not (all ones) an object voxel of the row.
template <typename Key>
[[gnu::always_inline]] inline int findObject(const Scratch<Key>& s, size_t row, int t, int length,
                                             uint64_t invert) {
  uint64_t bits = (s.object[row * s.words + size_t(t) / 64] ^ invert) & ~uint64_t(0) << (t & 63);
  for (t &= ~63; !bits;) {
    t += 64;
    if (t >= length) return length;
    bits = s.object[row * s.words + size_t(t) / 64] ^ invert;
  }
  return std::min(length, t + __builtin_ctzll(bits));
}

/// All runs of the pencil's rows.
template <typename Key>
VDB_MADF_SIMD void sweepRows(Key multiplier, Scratch<Key>& s) {
  const int length = int(s.leaves.size()) * 8;
  for (size_t row = 0; row < 64; ++row) {
    for (int end = 0; end < length;) {
      const int begin = findObject(s, row, end, length, 0);
      if (begin == length) break;
      end = findObject(s, row, begin, length, ~uint64_t(0));
      sweepRun(s, row, begin, end, multiplier);
    }
  }
}

template <int Axis, typename Key>
void sweep(const LeafIndex& index, Key multiplier, PowerMap& map, Interrupter* interrupter) {
  const std::vector<uint32_t> starts = detail::pencilStarts(index, Axis);
  detail::PerThread<Scratch<Key>> scratches;
  detail::parallelFor(starts.size(), detail::kPencilGrain, interrupter,
                      [&](size_t begin, size_t end) {
                        Scratch<Key>& s = scratches.local();
                        for (size_t p = begin; p < end; ++p) {
                          detail::collectPencil(index, Axis, starts[p], s.leaves);
                          s.resize(s.leaves.size() * 8);
                          gather<Axis, Key>(index, map, s);
                          computeRadii<Axis, Key>(index, index.origin(starts[p]), s);
                          markCandidates<Key>(s);
                          sweepRows<Key>(multiplier, s);
                          scatter<Axis, Key>(index, s, map);
                        }
                      });
}

template <typename Key>
void sweepAll(const LeafIndex& index, Key multiplier, PowerMap& map, Interrupter* interrupter) {
  detail::WorkPart first(interrupter, 0, 33), second(interrupter, 33, 66),
      third(interrupter, 66, 100);
  sweep<2, Key>(index, multiplier, map, &first);
  sweep<1, Key>(index, multiplier, map, &second);
  sweep<0, Key>(index, multiplier, map, &third);
}

/// Do products of a difference of keys and one of positions fit in 64 bits?
bool fits64Bits(const LeafIndex& index, int32_t largestSquaredRadius) {
  const Coord dim = index.boundingBox().dim();
  const double length = 8 + std::max({dim.x(), dim.y(), dim.z()});
  const double height = std::max<double>(length * length, largestSquaredRadius);
  return 2 * height * (double(largestSquaredRadius) + 2) * length < 9e18;
}

}  // namespace

void detail::sweepPower(const LeafIndex& index, int32_t maxSquaredRadius, PowerMap& map,
                        Interrupter* interrupter) {
  if (fits64Bits(index, maxSquaredRadius))
    sweepAll<int64_t>(index, int64_t(maxSquaredRadius) + 1, map, interrupter);
  else
    sweepAll<__int128>(index, __int128(maxSquaredRadius) + 1, map, interrupter);
}

PowerMap powerMap(const LeafIndex& index, SquaredDistance distance, Interrupter* interrupter) {
  PowerMap map;
  map.power = std::move(distance.values);
  map.site = VoxelArray<VoxelId>(size_t(index.voxelCount()));
  detail::parallelFor(map.power.size(), size_t(1) << 16, interrupter,
                      [&](size_t begin, size_t end) {
                        for (size_t i = begin; i < end; ++i) map.power[i] = -map.power[i];
                      });
  detail::sweepPower(index, distance.largest, map, interrupter);
  return map;
}

}  // namespace vdb_madf
