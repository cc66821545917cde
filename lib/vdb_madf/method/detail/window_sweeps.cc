// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/method/detail/window_sweeps.h"

#include "vdb_madf/base/detail/simd.h"
#include "vdb_madf/leaves/detail/pencil.h"
#include "vdb_madf/method/kernels/power_windows.h"
#include "vdb_madf/method/power_map.h"

namespace vdb_madf::detail {

namespace {

/// What one thread works with.
struct WindowRows {
  std::vector<uint32_t> leaves;  // of the pencil
  KeyLines lines;
};

/// Where a run of 8 voxels along z of the pencil's leaf number `leaf` is in the lines. Along z a
/// row is a line; else the runs of two rows lie side by side (pencil.h has the order of rows).
template <int Axis>
size_t placeOfRun(const KeyLines& lines, size_t leaf, int run) {
  const int x = run >> 3, y = run & 7, first = int(leaf) * 8;
  if (Axis == 2) return lines.at(run, first);
  const int row = Axis == 1 ? x : y;
  return lines.at(row >> 1, first + (Axis == 1 ? y : x)) + size_t(row & 1) * 8;
}

template <int Axis>
VDB_MADF_KERNEL void gather(const SweptLeaves& leaves, const PowerValues& values, int shift,
                            WindowRows& s) {
  int32_t key[512];
  VoxelId site[512];
  for (size_t i = 0; i < s.leaves.size(); ++i) {
    const uint32_t leaf = s.leaves[i];
    if (Axis == 2 || !leaves.carries(powerPass(Axis) - 1, leaf)) {
      // Before the first pass every voxel is its own site.
      leaves.expand(leaf, values.power.object, kUncovered, key);
      for (int32_t& k : key) k = k < 0 ? keyOfBall(-k, shift) : k;
      for (uint32_t k = 0; k < 512; ++k) site[k] = leaves.objectLeaf(leaf) * 512 + k;
    } else {
      leaves.expand(leaf, values.power, key);
      leaves.expand(leaf, values.site, site);
    }
    for (int run = 0; run < 64; ++run) {
      const size_t at = placeOfRun<Axis>(s.lines, i, run);
      std::copy_n(key + run * 8, 8, &s.lines.key[at]);
      std::copy_n(site + run * 8, 8, &s.lines.site[at]);
    }
  }
}

template <int Axis>
VDB_MADF_KERNEL void scatter(const SweptLeaves& leaves, const WindowRows& s, int shift,
                             PowerValues& values) {
  int32_t key[512];
  VoxelId site[512];
  for (size_t i = 0; i < s.leaves.size(); ++i) {
    const uint32_t leaf = s.leaves[i];
    if (!leaves.carries(powerPass(Axis), leaf)) continue;
    for (int run = 0; run < 64; ++run) {
      const size_t at = placeOfRun<Axis>(s.lines, i, run);
      std::copy_n(&s.lines.leastKey[at], 8, key + run * 8);
      std::copy_n(&s.lines.leastSite[at], 8, site + run * 8);
    }
    if (Axis == 0)
      for (int32_t& k : key) k = k < 0 ? powerOfKey(k, shift) : k;
    leaves.pack(leaf, key, Axis == 0, values.power);
    leaves.pack(leaf, site, Axis == 0, values.site);
  }
}

/// Between passes values.power holds keys.
template <int Axis>
void sweep(const SweptLeaves& leaves, const ForeignSites* foreign, int32_t maxSquaredRadius,
           const VoxelWeights& weights, PowerValues& values, Interrupter* interrupter) {
  const int shift = keyShift(maxSquaredRadius), reach = keyReach(maxSquaredRadius, weights[Axis]);
  const LeafIndex& index = leaves.index();
  const std::vector<uint32_t> starts = pencilStarts(index, Axis);
  PerThread<WindowRows> scratches;
  parallelFor(starts.size(), kPencilGrain, interrupter, [&](size_t begin, size_t end) {
    WindowRows& s = scratches.local();
    for (size_t p = begin; p < end; ++p) {
      collectPencil(index, Axis, starts[p], s.leaves);
      if (!leaves.anyCarries(powerPass(Axis), s.leaves)) continue;
      s.lines.resize(Axis == 2 ? 1 : 16, int(s.leaves.size()) * 8, reach);
      atBestLevel([&]() VDB_MADF_INLINE { gather<Axis>(leaves, values, shift, s); });
      if (Axis == 2 && foreign) foreign->addTo(index.origin(starts[p]), shift, s.lines);
      leastKeys(shift, weights[Axis], s.lines);
      atBestLevel([&]() VDB_MADF_INLINE { scatter<Axis>(leaves, s, shift, values); });
    }
  });
}

}  // namespace

void sweepWindows(const SweptLeaves& leaves, const ForeignSites* foreign, int32_t maxSquaredRadius,
                  const VoxelWeights& weights, PowerValues& values, Interrupter* interrupter) {
  WorkPart first(interrupter, 0, 33), second(interrupter, 33, 66), third(interrupter, 66, 100);
  sweep<2>(leaves, foreign, maxSquaredRadius, weights, values, &first);
  sweep<1>(leaves, nullptr, maxSquaredRadius, weights, values, &second);
  sweep<0>(leaves, nullptr, maxSquaredRadius, weights, values, &third);
}

}  // namespace vdb_madf::detail
