// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/method/squared_distance.h"

#include <algorithm>
#include <atomic>

#include "vdb_madf/base/detail/simd.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/base/limits.h"
#include "vdb_madf/leaves/detail/leaf_values.h"
#include "vdb_madf/leaves/detail/pencil.h"
#include "vdb_madf/method/detail/metric.h"

namespace vdb_madf {

namespace {

/// No background voxel known yet. Adding a squared row length to it does not overflow 32 bits.
constexpr uint32_t kInfinite = 1u << 31;
/// The same for linear distances of the first pass: more than any row is long.
constexpr uint32_t kFar = 40000;
static_assert(kFar > kMaxExtent + 8);

/// Lanes that stop their search for a nearer background voxel together.
constexpr int kLanes = 16;

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

/// Positions of a pencil that lie in the domain (all, where the boundary is closed) and what the
/// first position beyond its leaves counts as.
struct PencilDomain {
  int begin, end;          // positions [begin, end) lie in the domain
  uint32_t before, after;  // value of the padding: 0 (background) or infinite (unknown)
};

PencilDomain pencilDomain(const Obstacles& obstacles, int axis, int origin, int length) {
  if (!obstacles.open) return {0, length, 0, 0};
  const int64_t lower = int64_t(obstacles.domain.min()[axis]) - origin;
  const int64_t upper = int64_t(obstacles.domain.max()[axis]) - origin;
  return {int(std::max<int64_t>(lower, 0)), int(std::min<int64_t>(upper + 1, length)),
          lower < 0 ? 0 : kInfinite, upper >= length ? 0 : kInfinite};
}

/// First pass: distance along the row to the nearest background voxel, squared.
/// masks: one 64-row word per position.
VDB_MADF_SIMD void scanRows(const uint64_t* masks, int length, const PencilDomain& d,
                            uint32_t* out) {
  uint32_t state[64];
  const auto advance = [&](int t, uint32_t* slab, bool forward) {
    const uint64_t word = masks[t];
    const uint32_t outside = t >= d.begin && t < d.end ? 0 : kFar;
    for (int row = 0; row < 64; ++row) {
      const uint32_t inside = 0u - uint32_t(word >> row & 1);
      state[row] = ((state[row] + 1) & inside) | (outside & ~inside);
      slab[row] = forward ? state[row] : std::min(slab[row], state[row]);
    }
  };
  std::fill(state, state + 64, d.before ? kFar : 0);
  for (int t = 0; t < length; ++t) advance(t, out + (t + 1) * 64, true);
  std::fill(state, state + 64, d.after ? kFar : 0);
  for (int t = length - 1; t >= 0; --t) {
    uint32_t* slab = out + (t + 1) * 64;
    advance(t, slab, false);
    for (int row = 0; row < 64; ++row)
      slab[row] = slab[row] >= kFar ? kInfinite : detail::squaredAlong(slab[row]);
  }
}

/// Other passes: out(t) = min over k of in(t +- k) + k^2, searched outwards until no lane can gain.
/// in and out point to the slab of position 0; slabs -1 and `length` are the padding.
VDB_MADF_SIMD void widenWindows(const uint32_t* in, int length, uint32_t* out) {
  for (int t = 0; t < length; ++t) {
    for (int lane = 0; lane < 64; lane += kLanes) {
      const uint32_t* center = in + t * 64 + lane;
      uint32_t best[kLanes];
      uint32_t worst = 0;
      for (int i = 0; i < kLanes; ++i) {
        best[i] = center[i];
        worst = std::max(worst, best[i]);
      }
      const int both = std::min(t + 1, length - t);
      int k = 1;
      for (; k <= both && detail::squaredAlong(uint32_t(k)) < worst; ++k) {
        const uint32_t k2 = detail::squaredAlong(uint32_t(k));
        const uint32_t* below = center - k * 64;
        const uint32_t* above = center + k * 64;
        worst = 0;
        for (int i = 0; i < kLanes; ++i) {
          best[i] = std::min(best[i], std::min(below[i], above[i]) + k2);
          worst = std::max(worst, best[i]);
        }
      }
      // Beyond the nearer end only the other side is left.
      const int step = t + 1 < length - t ? 64 : -64;
      const int last = std::max(t + 1, length - t);
      for (; k <= last && detail::squaredAlong(uint32_t(k)) < worst; ++k) {
        const uint32_t k2 = detail::squaredAlong(uint32_t(k));
        const uint32_t* side = center + k * step;
        worst = 0;
        for (int i = 0; i < kLanes; ++i) {
          best[i] = std::min(best[i], side[i] + k2);
          worst = std::max(worst, best[i]);
        }
      }
      for (int i = 0; i < kLanes; ++i) out[t * 64 + lane + i] = std::min(best[i], kInfinite);
    }
  }
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
void sweep(const LeafIndex& index, const Obstacles& obstacles, VoxelArray<int32_t>& values,
           Interrupter* interrupter) {
  const std::vector<uint32_t> starts = detail::pencilStarts(index, Axis);
  detail::PerThread<Scratch> scratches;
  detail::parallelFor(
      starts.size(), detail::kPencilGrain, interrupter, [&](size_t begin, size_t end) {
        Scratch& s = scratches.local();
        for (size_t p = begin; p < end; ++p) {
          detail::collectPencil(index, Axis, starts[p], s.leaves);
          const int length = int(s.leaves.size()) * 8;
          s.resize(length);
          const PencilDomain d =
              pencilDomain(obstacles, Axis, index.origin(starts[p])[Axis], length);
          if (Axis == 0) {
            static_assert(sizeof(LeafIndex::Mask) == 64);
            s.masks.clear();
            for (const uint32_t leaf : s.leaves)
              s.masks.insert(s.masks.end(), index.mask(leaf).begin(), index.mask(leaf).end());
            scanRows(s.masks.data(), length, d, s.out.data());
          } else {
            gather<Axis>(index, values, s);
            // Outside the domain nothing is known: not background.
            std::fill_n(s.in.data(), 64, d.before);
            std::fill_n(s.in.data() + 64, size_t(d.begin) * 64, kInfinite);
            std::fill(s.in.data() + (d.end + 1) * 64, s.in.data() + (length + 1) * 64, kInfinite);
            std::fill_n(s.in.data() + (length + 1) * 64, 64, d.after);
            widenWindows(s.in.data() + 64, length, s.out.data() + 64);
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
                                Interrupter* interrupter) {
  if (obstacles.open && index.voxelCount() > 0 && index.boundingBox() == obstacles.domain &&
      uint64_t(index.voxelCount()) == obstacles.domain.volume())
    throw InvalidInput(
        "the object fills the whole domain: with the open boundary there is no "
        "background to measure distances from; use the closed boundary");
  SquaredDistance result;
  result.values = VoxelArray<int32_t>(size_t(index.voxelCount()));
  detail::WorkPart first(interrupter, 0, 20), second(interrupter, 20, 60),
      third(interrupter, 60, 100);
  sweep<0>(index, obstacles, result.values, &first);
  sweep<1>(index, obstacles, result.values, &second);
  sweep<2>(index, obstacles, result.values, &third);
  result.largest = largestValue(result.values);
  return result;
}

}  // namespace vdb_madf
