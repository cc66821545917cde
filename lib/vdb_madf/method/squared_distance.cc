// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/method/squared_distance.h"

#include <algorithm>
#include <atomic>

#include "vdb_madf/base/detail/simd.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/leaves/detail/leaf_values.h"
#include "vdb_madf/leaves/detail/pencil.h"
#include "vdb_madf/method/kernels/distance_rows.h"

namespace vdb_madf {

namespace {

/// A pencil laid out with the swept axis slow and its 64 rows side by side: values[(t + 1) * 64 +
/// row], one slab of padding at either end.
struct Scratch {
  std::vector<uint32_t> leaves;
  std::vector<uint64_t> masks;
  std::vector<uint32_t> in, out;
  void resize(size_t length) {
    if (in.size() >= (length + 2) * 64) return;
    in.resize((length + 2) * 64);
    out.resize((length + 2) * 64);
  }
};

detail::RowDomain rowDomain(const Obstacles& obstacles, int axis, int origin, int length) {
  if (!obstacles.open) return {0, length, 0, 0};
  const int64_t lower = int64_t(obstacles.domain.min()[axis]) - origin;
  const int64_t upper = int64_t(obstacles.domain.max()[axis]) - origin;
  return {int(std::max<int64_t>(lower, 0)), int(std::min<int64_t>(upper + 1, length)),
          lower < 0 ? 0 : detail::kInfinite, upper >= length ? 0 : detail::kInfinite};
}

template <int Axis>
VDB_MADF_SIMD void gather(const LeafIndex& index, const VoxelArray<int32_t>& values, Scratch& s) {
  int32_t dense[512];
  for (size_t i = 0; i < s.leaves.size(); ++i) {
    const uint32_t leaf = s.leaves[i];
    detail::expandLeaf(index.mask(leaf), values.data() + index.firstRank(leaf), dense);
    detail::copyToSlabs<Axis>(dense, 64, s.in.data() + (i * 8 + 1) * 64);
  }
}

template <int Axis>
VDB_MADF_SIMD void scatter(const LeafIndex& index, const Scratch& s, VoxelArray<int32_t>& values) {
  int32_t dense[512];
  for (size_t i = 0; i < s.leaves.size(); ++i) {
    const uint32_t leaf = s.leaves[i];
    detail::copyFromSlabs<Axis>(s.out.data() + (i * 8 + 1) * 64, 64, dense);
    detail::packLeaf(index.mask(leaf), dense, values.data() + index.firstRank(leaf));
  }
}

/// One sweep along an axis over all pencils. The array holds int32 values; infinite ones have the
/// sign bit set between passes.
template <int Axis>
void sweep(const LeafIndex& index, const Obstacles& obstacles, int32_t weight,
           VoxelArray<int32_t>& values, Interrupter* interrupter) {
  const std::vector<uint32_t> starts = detail::pencilStarts(index, Axis);
  detail::PerThread<Scratch> scratches;
  detail::parallelFor(
      starts.size(), detail::kPencilGrain, interrupter, [&](size_t begin, size_t end) {
        Scratch& s = scratches.local();
        for (size_t p = begin; p < end; ++p) {
          detail::collectPencil(index, Axis, starts[p], s.leaves);
          const int length = int(s.leaves.size()) * 8;
          s.resize(length);
          const detail::RowDomain d =
              rowDomain(obstacles, Axis, index.origin(starts[p])[Axis], length);
          if (Axis == 0) {
            static_assert(sizeof(LeafIndex::Mask) == 64);
            s.masks.clear();
            for (const uint32_t leaf : s.leaves)
              s.masks.insert(s.masks.end(), index.mask(leaf).begin(), index.mask(leaf).end());
            detail::scanRows(s.masks.data(), length, d, weight, s.out.data() + 64);
          } else {
            gather<Axis>(index, values, s);
            // Outside the domain nothing is known: not background.
            std::fill_n(s.in.data(), 64, d.before);
            std::fill_n(s.in.data() + 64, size_t(d.begin) * 64, detail::kInfinite);
            std::fill(s.in.data() + (d.end + 1) * 64, s.in.data() + (length + 1) * 64,
                      detail::kInfinite);
            std::fill_n(s.in.data() + (length + 1) * 64, 64, d.after);
            detail::widenWindows(s.in.data() + 64, length, weight, s.out.data() + 64);
          }
          scatter<Axis>(index, s, values);
        }
      });
}

int32_t largestValue(const VoxelArray<int32_t>& values) {
  std::atomic<int32_t> largest{0};
  detail::parallelFor(values.size(), size_t(1) << 16, nullptr, [&](size_t begin, size_t end) {
    const int32_t local = *std::max_element(values.data() + begin, values.data() + end);
    int32_t seen = largest.load();
    while (seen < local && !largest.compare_exchange_weak(seen, local)) {
    }
  });
  return largest;
}

}  // namespace

SquaredDistance squaredDistance(const LeafIndex& index, const Obstacles& obstacles,
                                const VoxelWeights& weights, Interrupter* interrupter) {
  if (obstacles.open && index.voxelCount() > 0 && index.boundingBox() == obstacles.domain &&
      uint64_t(index.voxelCount()) == obstacles.domain.volume())
    throw InvalidInput(
        "the object fills the whole domain, so there is no background to measure distances from; "
        "choose by value what is object, with a threshold or a phase");
  checkWeights(weights, index.boundingBox().dim());
  SquaredDistance result;
  result.weights = weights;
  result.values = VoxelArray<int32_t>(size_t(index.voxelCount()));
  detail::WorkPart first(interrupter, 0, 20), second(interrupter, 20, 60),
      third(interrupter, 60, 100);
  sweep<0>(index, obstacles, weights.x, result.values, &first);
  sweep<1>(index, obstacles, weights.y, result.values, &second);
  sweep<2>(index, obstacles, weights.z, result.values, &third);
  result.largest = largestValue(result.values);
  return result;
}

}  // namespace vdb_madf
