// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/power_map.h"

#include <utility>

#include "vdb_madf/detail/pencil.h"

namespace vdb_madf {

namespace {

/// A parabola of the lower envelope: u -> (u - position)^2 + offset, least from `start` on.
struct Parabola {
  int position;
  int start;
  int32_t offset;
  VoxelId site;

  int32_t at(int u) const { return (u - position) * (u - position) + offset; }
};

/// Rows of a pencil one after the other; a few unused values between them keep rows off the same
/// cache sets.
struct Scratch {
  std::vector<uint32_t> leaves;
  std::vector<int32_t> power;
  std::vector<VoxelId> site;
  std::vector<Parabola> envelope;
  size_t pitch = 0;

  void resize(size_t length) {
    pitch = length + 16;
    power.resize(pitch * 64);
    site.resize(pitch * 64);
    envelope.resize(length);
  }
};

/// D of a site, known from its partial power at a voxel of the row: the passes before this one have
/// moved away from the site along z, then y.
template <int Axis>
int32_t squaredRadius(const LeafIndex& index, const Coord& row, VoxelId site,
                      int32_t partialPower) {
  if (Axis == 2) return -partialPower;
  const Coord x = index.coord(site);
  const int dz = x.z() - row.z();
  const int dy = Axis == 0 ? x.y() - row.y() : 0;
  return dy * dy + dz * dz - partialPower;
}

/// Lower envelope over one run [0, length) of object voxels, in place. Sites are the positions of
/// negative power. Ties: larger D, then the smaller position (the order z, y, x of the passes makes
/// that the lexicographic order). Returns nothing where no parabola is negative.
template <int Axis>
void sweepRun(const LeafIndex& index, const Coord& row, int length, int32_t* power, VoxelId* site,
              Parabola* envelope) {
  // Does the later parabola win a tie against the earlier one?
  const auto winsTie = [&](const Parabola& later, const Parabola& earlier) {
    return squaredRadius<Axis>(index, row, later.site, later.offset) >
           squaredRadius<Axis>(index, row, earlier.site, earlier.offset);
  };
  const auto beats = [&](const Parabola& later, const Parabola& earlier, int u) {
    const int32_t a = later.at(u), b = earlier.at(u);
    return a < b || (a == b && winsTie(later, earlier));
  };

  int count = 0;
  for (int t = 0; t < length; ++t) {
    if (power[t] >= 0) continue;
    Parabola next{t, 0, power[t], site[t]};
    while (count > 0 && beats(next, envelope[count - 1], envelope[count - 1].start)) --count;
    if (count > 0) {
      const Parabola& top = envelope[count - 1];
      if (!beats(next, top, length - 1)) continue;
      // next < top at u  <=>  n < u * d. The quotient of such small integers is exact enough in
      // double precision for its floor to be that of the integer division.
      const int64_t n = int64_t(next.offset) - top.offset + int64_t(next.position) * next.position -
                        int64_t(top.position) * top.position;
      const int64_t d = 2 * int64_t(next.position - top.position);
      const int64_t quotient = int64_t(double(n) / double(d));
      next.start = int(quotient) + (quotient * d == n && winsTie(next, top) ? 0 : 1);
    }
    envelope[count++] = next;
  }

  for (int i = 0, u = 0; u < length; ++i) {
    if (i == count) {  // only where there is no site at all
      std::fill(power, power + length, kUncovered);
      return;
    }
    const Parabola& p = envelope[i];
    const int end = i + 1 < count ? envelope[i + 1].start : length;
    for (; u < end; ++u) {
      const int32_t value = p.at(u);
      power[u] = value < 0 ? value : kUncovered;
      site[u] = p.site;
    }
  }
}

template <int Axis>
void sweep(const LeafIndex& index, PowerMap& map, Interrupter* interrupter) {
  constexpr int kStride = detail::rowStride<Axis>();
  const std::vector<uint32_t> starts = detail::pencilStarts(index, Axis);
  detail::PerThread<Scratch> scratches;
  detail::parallelFor(
      starts.size(), detail::kPencilGrain, interrupter, [&](size_t begin, size_t end) {
        Scratch& s = scratches.local();
        for (size_t p = begin; p < end; ++p) {
          detail::collectPencil(index, Axis, starts[p], s.leaves);
          const int length = int(s.leaves.size()) * 8;
          s.resize(length);
          for (size_t i = 0; i < s.leaves.size(); ++i) {
            const size_t leaf = size_t(s.leaves[i]) * 512;
            for (int row = 0; row < 64; ++row) {
              const size_t from = leaf + detail::rowOffset<Axis>(row), to = row * s.pitch + i * 8;
              for (int t = 0; t < 8; ++t) {
                s.power[to + t] = map.power[from + t * kStride];
                // Before the first pass every voxel is its own site.
                s.site[to + t] = Axis == 2 ? VoxelId(from + t) : map.site[from + t * kStride];
              }
            }
          }
          const Coord origin = index.origin(starts[p]);
          for (int row = 0; row < 64; ++row) {
            int32_t* power = s.power.data() + row * s.pitch;
            VoxelId* site = s.site.data() + row * s.pitch;
            const int slow = row >> 3, fast = row & 7;
            const Coord rowCoord = origin + (Axis == 0   ? Coord(0, slow, fast)
                                             : Axis == 1 ? Coord(slow, 0, fast)
                                                         : Coord(slow, fast, 0));
            for (int a = 0; a < length;) {
              if (power[a] == 0) {
                ++a;
                continue;
              }
              int b = a + 1;
              while (b < length && power[b] != 0) ++b;
              sweepRun<Axis>(index, rowCoord, b - a, power + a, site + a, s.envelope.data());
              a = b;
            }
          }
          for (size_t i = 0; i < s.leaves.size(); ++i) {
            const size_t leaf = size_t(s.leaves[i]) * 512;
            for (int row = 0; row < 64; ++row) {
              const size_t to = leaf + detail::rowOffset<Axis>(row), from = row * s.pitch + i * 8;
              for (int t = 0; t < 8; ++t) {
                map.power[to + t * kStride] = s.power[from + t];
                map.site[to + t * kStride] = s.site[from + t];
              }
            }
          }
        }
      });
}

}  // namespace

PowerMap powerMap(const LeafIndex& index, VoxelArray<int32_t> squaredDistance,
                  Interrupter* interrupter) {
  PowerMap map;
  map.power = std::move(squaredDistance);
  map.site = VoxelArray<VoxelId>(index.idCount());
  detail::parallelFor(map.power.size(), size_t(1) << 16, interrupter,
                      [&](size_t begin, size_t end) {
                        for (size_t i = begin; i < end; ++i) map.power[i] = -map.power[i];
                      });
  sweepPower(index, map, interrupter);
  return map;
}

void sweepPower(const LeafIndex& index, PowerMap& map, Interrupter* interrupter) {
  sweep<2>(index, map, interrupter);
  sweep<1>(index, map, interrupter);
  sweep<0>(index, map, interrupter);
}

}  // namespace vdb_madf
