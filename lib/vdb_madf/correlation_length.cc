// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/correlation_length.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <numeric>
#include <vector>

#include "vdb_madf/detail/parallel.h"
#include "vdb_madf/detail/simd.h"

namespace vdb_madf {

namespace {

constexpr size_t kLeafGrain = 1024;
constexpr uint64_t kFirstZ = 0x0101010101010101ull;

/// Voxels that two leaves have in common.
VDB_MADF_SIMD int64_t common(const uint64_t* a, const uint64_t* b) {
  int64_t count = 0;
  for (int i = 0; i < 8; ++i) count += __builtin_popcountll(a[i] & b[i]);
  return count;
}

/// The leaves in pencils along an axis.
class Pencils {
 public:
  Pencils(const LeafIndex& index, int axis)
      : index_(&index), axis_(axis), order_(index.leafCount()) {
    std::iota(order_.begin(), order_.end(), uint32_t(0));
    const int a = (axis + 1) % 3, b = (axis + 2) % 3;
    if (axis != 2)  // the order of the index
      std::sort(order_.begin(), order_.end(), [&](uint32_t i, uint32_t j) {
        const Coord &p = index.origin(i), &q = index.origin(j);
        if (p[a] != q[a]) return p[a] < q[a];
        if (p[b] != q[b]) return p[b] < q[b];
        return p[axis] < q[axis];
      });
  }

  /// Number of object voxels with an object voxel `lag` further along the axis.
  int64_t pairs(int lag, Interrupter* interrupter) const {
    std::atomic<int64_t> sum{0};
    detail::parallelFor(order_.size(), kLeafGrain, interrupter, [&](size_t begin, size_t end) {
      int64_t part = 0;
      for (size_t i = begin; i < end; ++i) part += pairsOfLeaf(i, lag);
      sum += part;  // integers: any order
    });
    return sum;
  }

 private:
  int64_t pairsOfLeaf(size_t i, int lag) const {
    static constexpr LeafIndex::Mask kEmpty{};
    // The shifted leaf lies across two others of its pencil.
    Coord target = index_->origin(order_[i]);
    target[axis_] += lag & ~7;
    const int behind = target[axis_] + 8;
    const LeafIndex::Mask *near = &kEmpty, *far = &kEmpty;
    for (size_t j = i; j < order_.size(); ++j) {
      const Coord& origin = index_->origin(order_[j]);
      const int at = origin[axis_];
      Coord samePencil = origin;
      samePencil[axis_] = target[axis_];
      if (samePencil != target || at > behind) break;
      if (at == target[axis_]) near = &index_->mask(order_[j]);
      if (at == behind) far = &index_->mask(order_[j]);
    }
    const LeafIndex::Mask& own = index_->mask(order_[i]);
    const int s = lag & 7;
    LeafIndex::Mask across;
    for (int x = 0; x < 8; ++x) {
      uint64_t& shifted = across[size_t(x)];
      if (axis_ == 0) {
        shifted = x + s < 8 ? (*near)[size_t(x + s)] : (*far)[size_t(x + s - 8)];
      } else {
        const uint64_t a = (*near)[size_t(x)], b = (*far)[size_t(x)];
        if (s == 0) {
          shifted = a;
        } else if (axis_ == 1) {
          shifted = a >> 8 * s | b << (64 - 8 * s);
        } else {
          const uint64_t low = kFirstZ * ((1u << (8 - s)) - 1);  // z from 0 to 7 - s
          shifted = (a >> s & low) | (b << (8 - s) & ~low);
        }
      }
    }
    return common(own.data(), across.data());
  }

  const LeafIndex* index_;
  int axis_;
  std::vector<uint32_t> order_;
};

}  // namespace

std::array<std::optional<double>, 3> correlationLengths(const LeafIndex& index,
                                                        const CoordBBox& box,
                                                        Interrupter* interrupter) {
  std::array<std::optional<double>, 3> lengths;
  if (index.voxelCount() == 0) return lengths;
  const double share = double(index.voxelCount()) / double(box.volume());
  if (!(share < 1)) return lengths;
  const double target = std::exp(-1.0);
  for (int axis = 0; axis < 3; ++axis) {
    const Pencils pencils(index, axis);
    const int extent = box.dim()[axis];
    const double section = double(box.volume()) / extent;
    double before = 1;
    for (int lag = 1; 2 * lag <= extent; ++lag) {
      const double both = double(pencils.pairs(lag, interrupter)) / (section * (extent - lag));
      const double correlation = (both - share * share) / (share - share * share);
      if (correlation <= target) {
        lengths[size_t(axis)] = lag - 1 + (before - target) / (before - correlation);
        break;
      }
      before = correlation;
    }
  }
  return lengths;
}

}  // namespace vdb_madf
