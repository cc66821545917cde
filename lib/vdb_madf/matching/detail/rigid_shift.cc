// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/matching/detail/rigid_shift.h"

#include <algorithm>
#include <atomic>
#include <map>
#include <tuple>
#include <utility>

#include "vdb_madf/base/detail/bits.h"
#include "vdb_madf/base/detail/parallel.h"
#include "vdb_madf/grids/object_mask.h"
#include "vdb_madf/leaves/detail/leaf_mask.h"

namespace vdb_madf::detail {

namespace {

using LeafVoxels = LeafIndex::LeafVoxels;
using Mask = LeafIndex::Mask;

constexpr int kSearched = 3;    // all shifts up to this are tried
constexpr size_t kRefined = 4;  // best ones that are looked at more closely

int64_t voxelCount(const VoxelSetByLeaves& voxels) {
  int64_t sum = 0;
  for (const LeafVoxels& leaf : voxels) sum += countVoxels(leaf.mask);
  return sum;
}

/// A word of a mask in which bit (y, z) is what (y + dy, z + dz) was, 0 from outside.
uint64_t movedWord(uint64_t word, int dy, int dz) {
  word = dy >= 0 ? word >> 8 * dy : word << 8 * -dy;
  constexpr uint64_t kRows = kFirstZ;  // a bit in each row
  if (dz >= 0) return word >> dz & kRows * (0xffu >> dz);
  return word << -dz & kRows * (0xffu << -dz & 0xffu);
}

/// Voxels of `mask` that are in `other` when moved by d, 0 to 7 from there the corner's leaf on.
int64_t commonInCorner(const Mask& mask, const Mask& other, const Coord& d, const Coord& corner) {
  int64_t sum = 0;
  const int dx = d.x() - 8 * corner.x(), dy = d.y() - 8 * corner.y(), dz = d.z() - 8 * corner.z();
  for (int x = std::max(0, -dx); x < std::min(8, 8 - dx); ++x)
    sum += countBits(mask[size_t(x)] & movedWord(other[size_t(x + dx)], dy, dz));
  return sum;
}

/// Half the size: a voxel for each 2 x 2 x 2 that holds `least` voxels.
VoxelSetByLeaves halved(const VoxelSetByLeaves& voxels, uint32_t least) {
  std::map<Coord, Mask> coarse;
  for (const LeafVoxels& leaf : voxels) {
    const Coord half(leaf.origin.x() >> 1, leaf.origin.y() >> 1, leaf.origin.z() >> 1);
    const Coord origin(half.x() & ~7, half.y() & ~7, half.z() & ~7), at = half - origin;
    Mask* mask = nullptr;
    for (int x = 0; x < 4; ++x)
      for (int y = 0; y < 4; ++y)
        for (int z = 0; z < 4; ++z) {
          const uint64_t square = uint64_t(0x0303) << (16 * y + 2 * z);
          if (countBits(leaf.mask[size_t(2 * x)] & square) +
                  countBits(leaf.mask[size_t(2 * x + 1)] & square) <
              least)
            continue;
          if (!mask) mask = &coarse.try_emplace(origin, Mask{}).first->second;
          (*mask)[size_t(at.x() + x)] |= uint64_t(1) << (8 * (at.y() + y) + at.z() + z);
        }
  }
  VoxelSetByLeaves result;
  for (const auto& [origin, mask] : coarse) result.push_back({origin, mask});
  return result;
}

/// Both sets at half their size, by the same rule.
std::pair<VoxelSetByLeaves, VoxelSetByLeaves> halved(const VoxelSetByLeaves& first,
                                                     const VoxelSetByLeaves& second) {
  constexpr int64_t kKept = 2;  // at least 1 / kKept of the volume
  for (const uint32_t least : {4u, 2u}) {
    auto a = halved(first, least), b = halved(second, least);
    if (8 * kKept * voxelCount(a) >= voxelCount(first) &&
        8 * kKept * voxelCount(b) >= voxelCount(second))
      return {std::move(a), std::move(b)};
  }
  return {halved(first, 1), halved(second, 1)};
}

/// Many counts are one work, whose end is not known: their percentages would tell nothing.
class WithoutPercent : public Interrupter {
 public:
  explicit WithoutPercent(Interrupter* whole) : whole_(whole) {}
  bool wasInterrupted(int) override { return whole_ && whole_->wasInterrupted(-1); }

 private:
  Interrupter* whole_;
};

/// The shifts that were tried between two sets, and how good they are.
class Trials {
 public:
  Trials(const VoxelSetByLeaves& first, const VoxelSetByLeaves& second, int most,
         Interrupter* interrupter)
      : first_(first), second_(second), most_(most), interrupter_(interrupter) {}

  void add(const Coord& shift) {
    for (int axis = 0; axis < 3; ++axis)
      if (shift[axis] < -most_ || shift[axis] > most_) return;
    if (tried_.count(shift) == 0)
      tried_[shift] = commonVoxels(first_, second_, shift, &interrupter_);
  }
  void addAround(const Coord& shift) {
    for (int x = -1; x <= 1; ++x)
      for (int y = -1; y <= 1; ++y)
        for (int z = -1; z <= 1; ++z) add(shift.offsetBy(x, y, z));
  }
  std::vector<Coord> best() const {
    std::vector<std::tuple<int64_t, int64_t, Coord>> order;
    for (const auto& [shift, common] : tried_)
      order.emplace_back(-common,
                         int64_t(shift.x()) * shift.x() + int64_t(shift.y()) * shift.y() +
                             int64_t(shift.z()) * shift.z(),
                         shift);
    std::sort(order.begin(), order.end());
    std::vector<Coord> shifts;
    for (size_t i = 0; i < std::min(kRefined, order.size()); ++i)
      shifts.push_back(std::get<2>(order[i]));
    return shifts;
  }

 private:
  const VoxelSetByLeaves &first_, &second_;
  int most_;
  WithoutPercent interrupter_;
  std::map<Coord, int64_t> tried_;
};

Coord doubled(const Coord& shift) {
  return {2 * shift.x(), 2 * shift.y(), 2 * shift.z()};
}

/// The best few, best first. The recursion is as deep as `most` has bits.
std::vector<Coord> bestShifts(const VoxelSetByLeaves& first, const VoxelSetByLeaves& second,
                              int most, Interrupter* interrupter) {
  Trials trials(first, second, most, interrupter);
  if (most <= kSearched) {
    for (int x = -most; x <= most; ++x)
      for (int y = -most; y <= most; ++y)
        for (int z = -most; z <= most; ++z) trials.add(Coord(x, y, z));
  } else {
    const auto [a, b] = halved(first, second);
    for (const Coord& shift : bestShifts(a, b, (most + 1) / 2, interrupter))
      trials.addAround(doubled(shift));
  }
  return trials.best();
}

}  // namespace

VoxelSetByLeaves labelledVoxels(const Int32Grid& labels) {
  const LeafIndex index(*objectMask(labels));
  VoxelSetByLeaves voxels(index.leafCount());
  for (size_t leaf = 0; leaf < voxels.size(); ++leaf)
    voxels[leaf] = {index.origin(leaf), index.mask(leaf)};
  return voxels;
}

int64_t commonVoxels(const VoxelSetByLeaves& before, const VoxelSetByLeaves& after,
                     const Coord& shift, Interrupter* interrupter) {
  constexpr size_t kGrain = 4096;
  // The leaf at o is moved to d past the leaf at o + whole, and so across up to eight leaves.
  const Coord d(shift.x() & 7, shift.y() & 7, shift.z() & 7), whole = shift - d;
  std::atomic<int64_t> sum{0};
  parallelFor(before.size(), kGrain, interrupter, [&](size_t begin, size_t end) {
    int64_t local = 0;
    for (int n = 0; n < 8; ++n) {
      const Coord corner(n >> 2, n >> 1 & 1, n & 1);
      if ((corner.x() && !d.x()) || (corner.y() && !d.y()) || (corner.z() && !d.z())) continue;
      const Coord by = whole.offsetBy(8 * corner.x(), 8 * corner.y(), 8 * corner.z());
      // Both ascend: each step goes on where the last one ended.
      auto other =
          std::lower_bound(after.begin(), after.end(), before[begin].origin + by, ByOrigin());
      for (size_t leaf = begin; leaf < end; ++leaf) {
        const Coord wanted = before[leaf].origin + by;
        while (other != after.end() && other->origin < wanted) ++other;
        if (other == after.end()) break;
        if (other->origin == wanted)
          local += commonInCorner(before[leaf].mask, other->mask, d, corner);
      }
    }
    sum += local;  // of integers: the order does not matter
  });
  return sum;
}

Coord findShift(const VoxelSetByLeaves& before, const VoxelSetByLeaves& after, int most,
                Interrupter* interrupter) {
  if (most <= kSearched) return bestShifts(before, after, most, interrupter).at(0);
  Trials trials(before, after, most, interrupter);
  {
    const auto [a, b] = halved(before, after);
    for (const Coord& shift : bestShifts(a, b, (most + 1) / 2, interrupter))
      trials.add(doubled(shift));
  }
  for (Coord best = trials.best().at(0);;) {
    trials.addAround(best);
    const Coord better = trials.best().at(0);
    if (better == best) return best;
    best = better;
  }
}

}  // namespace vdb_madf::detail
