// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/method/squared_distance.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>

#include "vdb_madf/base/detail/simd.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/leaves/detail/leaf_mask.h"
#include "vdb_madf/leaves/detail/pencil.h"
#include "vdb_madf/method/detail/check_background.h"
#include "vdb_madf/method/detail/passage.h"
#include "vdb_madf/method/detail/slab_faces.h"
#include "vdb_madf/method/detail/swept_leaves.h"
#include "vdb_madf/method/kernels/distance_rows.h"

namespace vdb_madf {

namespace {

using Leaves = detail::SweptLeaves;
using Values = detail::SweptValues<int32_t>;

/// A pencil laid out with the swept axis slow and its 64 rows side by side: values[(t + 1) * 64 +
/// row], one slab of padding at either end.
struct PencilRows {
  std::vector<uint32_t> leaves;
  std::vector<uint64_t> masks;
  std::vector<uint32_t> in, out;
  void resize(size_t length) {
    if (in.size() >= (length + 2) * 64) return;
    in.resize((length + 2) * 64);
    out.resize((length + 2) * 64);
  }
};

using RowEnds = std::array<uint32_t, 64>;

/// What lies beyond the ends of the 64 rows of a pencil: 0 where that is background, kInfinite
/// where it is outside the region. `origin` is that of the leaf there, `last` says which of its
/// slabs.
template <int Axis>
RowEnds beyondRegion(const Domain& region, const Coord& origin, bool last) {
  const LeafIndex::Mask inside = detail::insideMask(region, origin);
  RowEnds ends;
  for (int row = 0; row < 64; ++row) {
    const int offset = detail::rowOffset<Axis>(row) + (last ? 7 * detail::rowStride<Axis>() : 0);
    ends[size_t(row)] = detail::holds(inside, uint32_t(offset)) ? 0 : detail::kInfinite;
  }
  return ends;
}

/// Of the pencil of `length` voxels whose first leaf is at `origin`.
template <int Axis>
detail::RowDomain rowDomain(const Obstacles& obstacles, const Coord& origin, int length) {
  if (!obstacles.open) return {0, length, {}, {}};
  if (!obstacles.domain.isBox()) {
    Coord before = origin, after = origin;
    before[Axis] -= 8;
    after[Axis] += length;
    return {0, length, beyondRegion<Axis>(obstacles.domain, before, true),
            beyondRegion<Axis>(obstacles.domain, after, false)};
  }
  const CoordBBox& box = obstacles.domain.box();
  const int64_t lower = int64_t(box.min()[Axis]) - origin[Axis];
  const int64_t upper = int64_t(box.max()[Axis]) - origin[Axis];
  detail::RowDomain d{
      int(std::max<int64_t>(lower, 0)), int(std::min<int64_t>(upper + 1, length)), {}, {}};
  if (lower >= 0) d.before.fill(detail::kInfinite);
  if (upper < length) d.after.fill(detail::kInfinite);
  return d;
}

template <int Axis>
VDB_MADF_KERNEL void gather(const Leaves& leaves, const Values& values, PencilRows& s) {
  int32_t dense[512];
  for (size_t i = 0; i < s.leaves.size(); ++i) {
    leaves.expand(s.leaves[i], values, dense);
    detail::copyToSlabs<Axis>(dense, 64, s.in.data() + (i * 8 + 1) * 64);
  }
}

template <int Axis>
VDB_MADF_KERNEL void scatter(const Leaves& leaves, const PencilRows& s, Values& values) {
  int32_t dense[512];
  for (size_t i = 0; i < s.leaves.size(); ++i) {
    if (!leaves.carries(Axis, s.leaves[i])) continue;
    detail::copyFromSlabs<Axis>(s.out.data() + (i * 8 + 1) * 64, 64, dense);
    leaves.pack(s.leaves[i], dense, Axis == 2, values);
  }
}

/// Of the pencil in s.in. All that a leaf looks at carried values before.
template <int Axis>
void widen(const Leaves& leaves, const detail::RowDomain& d, int32_t weight, int reach,
           PencilRows& s) {
  const int length = int(s.leaves.size()) * 8;
  // Outside the domain nothing is known: not background.
  std::copy(d.before.begin(), d.before.end(), s.in.data());
  std::fill_n(s.in.data() + 64, size_t(d.begin) * 64, detail::kInfinite);
  std::fill(s.in.data() + (d.end + 1) * 64, s.in.data() + (length + 1) * 64, detail::kInfinite);
  std::copy(d.after.begin(), d.after.end(), s.in.data() + (length + 1) * 64);
  const detail::LeastOfRows least = detail::leastOfRows(s.in.data() + 64, length);
  for (size_t i = 0, next; i < s.leaves.size(); i = next) {
    const bool carries = leaves.carries(Axis, s.leaves[i]);
    for (next = i + 1; next < s.leaves.size(); ++next)
      if (leaves.carries(Axis, s.leaves[next]) != carries) break;
    if (carries)
      detail::widenWindows(s.in.data() + 64, least, length, int(i) * 8, int(next) * 8, weight,
                           reach, s.out.data() + 64);
  }
}

/// The masks of a pencil as slabs: bit `row` of a word tells whether a voxel is in the object.
template <int Axis>
void collectMasks(const LeafIndex& index, PencilRows& s) {
  static_assert(sizeof(LeafIndex::Mask) == 64 && (Axis == 0 || Axis == 2));
  s.masks.clear();
  for (const uint32_t leaf : s.leaves) {
    const LeafIndex::Mask slabs =
        Axis == 0 ? index.mask(leaf) : detail::layersAlongZ(index.mask(leaf));
    s.masks.insert(s.masks.end(), slabs.begin(), slabs.end());
  }
}

/// What a pass along z finds at the cuts of a slab, unless the domain ends there.
void continueBeyond(const detail::SlabFaces& faces, const Obstacles& obstacles, const Coord& origin,
                    int length, detail::RowDomain& d) {
  if (faces.hasBelow && origin.z() == faces.begin && !detail::isUnknown(obstacles, faces.begin - 1))
    d.before = faces.below.of(origin);
  if (faces.hasAbove && origin.z() + length == faces.end &&
      !detail::isUnknown(obstacles, faces.end))
    d.after = faces.above.of(origin);
}

/// One sweepPencils along an axis over all pencils; the first one starts from masks. The array
/// holds int32 values; infinite ones have the sign bit set between passes.
template <int Axis, bool First>
void sweepPencils(const Leaves& leaves, const Obstacles& obstacles, const detail::SlabFaces* faces,
                  int32_t weight, int reach, Values& values, Interrupter* interrupter) {
  const LeafIndex& index = leaves.index();
  const std::vector<uint32_t> starts = detail::pencilStarts(index, Axis);
  detail::PerThread<PencilRows> scratches;
  detail::parallelFor(
      starts.size(), detail::kPencilGrain, interrupter, [&](size_t begin, size_t end) {
        PencilRows& s = scratches.local();
        for (size_t p = begin; p < end; ++p) {
          detail::collectPencil(index, Axis, starts[p], s.leaves);
          if (!leaves.anyCarries(Axis, s.leaves)) continue;
          const int length = int(s.leaves.size()) * 8;
          s.resize(length);
          const Coord& origin = index.origin(starts[p]);
          detail::RowDomain d = rowDomain<Axis>(obstacles, origin, length);
          if constexpr (First) {
            if (faces) continueBeyond(*faces, obstacles, origin, length, d);
            collectMasks<Axis>(index, s);
            detail::scanRows(s.masks.data(), length, d, weight, s.out.data() + 64);
          } else {
            detail::atBestLevel([&]() VDB_MADF_INLINE { gather<Axis>(leaves, values, s); });
            widen<Axis>(leaves, d, weight, reach, s);
          }
          detail::atBestLevel([&]() VDB_MADF_INLINE { scatter<Axis>(leaves, s, values); });
        }
      });
}

/// How far a sweepPencils has to look along an axis of that weight for all distances up to
/// `exactUpTo`.
int reachAlong(uint32_t exactUpTo, int32_t weight) {
  if (exactUpTo == detail::kInfinite) return std::numeric_limits<int>::max();
  return int(std::sqrt(double(exactUpTo) / weight)) + 1;
}

void sweepAll(const Leaves& leaves, const Obstacles& obstacles, const VoxelWeights& weights,
              uint32_t exactUpTo, VoxelArray<int32_t>& ofObject, Interrupter* interrupter) {
  Values values{ofObject, VoxelArray<int32_t>(leaves.unknownVoxels())};
  detail::WorkPart first(interrupter, 0, 20), second(interrupter, 20, 60),
      third(interrupter, 60, 100);
  const auto reach = [&](int32_t weight) { return reachAlong(exactUpTo, weight); };
  sweepPencils<0, true>(leaves, obstacles, nullptr, weights.x, reach(weights.x), values, &first);
  sweepPencils<1, false>(leaves, obstacles, nullptr, weights.y, reach(weights.y), values, &second);
  sweepPencils<2, false>(leaves, obstacles, nullptr, weights.z, reach(weights.z), values, &third);
}

/// Infinite values are the largest.
uint32_t largestValue(const VoxelArray<int32_t>& values) {
  std::atomic<uint32_t> largest{0};
  detail::parallelFor(values.size(), size_t(1) << 16, nullptr, [&](size_t begin, size_t end) {
    const auto* const unsignedValues = reinterpret_cast<const uint32_t*>(values.data());
    const uint32_t local = *std::max_element(unsignedValues + begin, unsignedValues + end);
    uint32_t seen = largest.load();
    while (seen < local && !largest.compare_exchange_weak(seen, local)) {
    }
  });
  return largest;
}

/// Most balls are smaller than the first reach. If there is a larger one, the value found for it is
/// the distance of some background voxel, so it tells how far to reach to find all that are nearer.
void measureInRegion(const LeafIndex& index, const Obstacles& obstacles, Interrupter* interrupter,
                     SquaredDistance& result) {
  constexpr int kFirstReach = 32;
  const VoxelWeights& weights = result.weights;
  for (int reach = kFirstReach;;) {
    const detail::Passage passage(index, obstacles.domain, reach, weights);
    const uint32_t exact = passage.exactUpTo();
    sweepAll({index, &passage}, obstacles, weights, exact, result.values, interrupter);
    const uint32_t largest = largestValue(result.values);
    result.largest = int32_t(largest);
    if (largest <= exact) break;
    reach = largest == detail::kInfinite
                ? 2 * reach
                : int(std::ceil(std::sqrt(double(largest) / weights.least())));
  }
  result.passage =
      std::make_shared<detail::Passage>(index, obstacles.domain, result.values, weights);
}

}  // namespace

void detail::checkBackground(const Obstacles& obstacles, int64_t objectVoxels) {
  if (obstacles.open && objectVoxels > 0 && objectVoxels == obstacles.domain.voxelCount())
    throw InvalidInput(
        "the object fills the whole domain, so there is no background to measure distances from; "
        "choose by value what is object, with a threshold or a phase");
}

SquaredDistance squaredDistance(const LeafIndex& index, const Obstacles& obstacles,
                                const VoxelWeights& weights, Interrupter* interrupter) {
  detail::checkBackground(obstacles, index.voxelCount());
  const bool region = obstacles.inRegion() && index.voxelCount() > 0;
  checkWeights(weights, region ? obstacles.domain.box().dim() : index.boundingBox().dim());
  SquaredDistance result;
  result.weights = weights;
  result.values = VoxelArray<int32_t>(size_t(index.voxelCount()));
  if (region) {
    measureInRegion(index, obstacles, interrupter, result);
    return result;
  }
  sweepAll({index, nullptr}, obstacles, weights, detail::kInfinite, result.values, interrupter);
  result.largest = int32_t(largestValue(result.values));
  return result;
}

SquaredDistance detail::squaredDistanceInSlab(const LeafIndex& index, const Obstacles& obstacles,
                                              const VoxelWeights& weights, const SlabFaces& faces,
                                              Interrupter* interrupter) {
  SquaredDistance result;
  result.weights = weights;
  result.values = VoxelArray<int32_t>(size_t(index.voxelCount()));
  const Leaves leaves(index, nullptr);
  Values values{result.values, {}};
  constexpr int kFarthest = std::numeric_limits<int>::max();
  WorkPart first(interrupter, 0, 20), second(interrupter, 20, 60), third(interrupter, 60, 100);
  sweepPencils<2, true>(leaves, obstacles, &faces, weights.z, kFarthest, values, &first);
  sweepPencils<0, false>(leaves, obstacles, nullptr, weights.x, kFarthest, values, &second);
  sweepPencils<1, false>(leaves, obstacles, nullptr, weights.y, kFarthest, values, &third);
  const uint32_t largest = largestValue(result.values);
  if (largest >= kInfinite)
    throw InvalidInput(
        "the object is so thick that squared distances overflow: coarsen the volume");
  result.largest = int32_t(largest);
  return result;
}

}  // namespace vdb_madf
