// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/measure/correlation_length.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <numeric>
#include <vector>

#include "vdb_madf/base/detail/bits.h"
#include "vdb_madf/base/detail/parallel.h"
#include "vdb_madf/base/detail/simd.h"
#include "vdb_madf/leaves/detail/voxels.h"
#include "vdb_madf/measure/detail/domain_pairs.h"

namespace vdb_madf {

namespace {

constexpr size_t kLeafGrain = 1024;

/// A leaf, and the two that lie across it once it is shifted along its pencil; null: none.
struct Across {
  const uint64_t *own, *near, *far;
};

/// Voxels of the leaves that have another `shift` further along the axis, 0 to 7.
VDB_MADF_SIMD int64_t countPairs(const Across* leaves, size_t count, int axis, int shift) {
  static constexpr uint64_t kEmpty[8] = {};
  const uint64_t low = detail::kFirstZ * ((1u << (8 - shift)) - 1);  // z from 0 to 7 - shift
  int64_t sum = 0;
  for (const Across* leaf = leaves; leaf != leaves + count; ++leaf) {
    const uint64_t *own = leaf->own, *near = leaf->near, *far = shift ? leaf->far : nullptr;
    if (!near && !far) continue;
    if (!near) near = kEmpty;
    if (!far) far = kEmpty;
    uint32_t both = 0;
    if (axis == 0) {
      for (int x = 0; x < 8 - shift; ++x) both += detail::countBits(own[x] & near[x + shift]);
      for (int x = 8 - shift; x < 8; ++x) both += detail::countBits(own[x] & far[x + shift - 8]);
    } else if (shift == 0) {
      for (int x = 0; x < 8; ++x) both += detail::countBits(own[x] & near[x]);
    } else if (axis == 1) {
      for (int x = 0; x < 8; ++x)
        both += detail::countBits(own[x] & (near[x] >> 8 * shift | far[x] << (64 - 8 * shift)));
    } else {
      for (int x = 0; x < 8; ++x)
        both +=
            detail::countBits(own[x] & ((near[x] >> shift & low) | (far[x] << (8 - shift) & ~low)));
    }
    sum += both;
  }
  return sum;
}

/// The leaves in pencils along an axis.
class Pencils {
 public:
  Pencils(const LeafIndex& index, int axis)
      : index_(&index), axis_(axis), order_(index.leafCount()), across_(index.leafCount()) {
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
  int64_t pairs(int lag, Interrupter* interrupter) {
    std::atomic<int64_t> sum{0};
    detail::parallelFor(order_.size(), kLeafGrain, interrupter, [&](size_t begin, size_t end) {
      if (lag >> 3 != leavesApart_)
        for (size_t i = begin; i < end; ++i) across_[i] = across(i, lag & ~7);
      sum += countPairs(&across_[begin], end - begin, axis_, lag & 7);  // integers: any order
    });
    leavesApart_ = lag >> 3;
    return sum;
  }

 private:
  Across across(size_t i, int shift) const {
    Coord target = index_->origin(order_[i]);
    target[axis_] += shift;
    const int behind = target[axis_] + 8;
    Across found = {index_->mask(order_[i]).data(), nullptr, nullptr};
    for (size_t j = i; j < order_.size(); ++j) {
      const Coord& origin = index_->origin(order_[j]);
      const int at = origin[axis_];
      Coord samePencil = origin;
      samePencil[axis_] = target[axis_];
      if (samePencil != target || at > behind) break;
      if (at == target[axis_]) found.near = index_->mask(order_[j]).data();
      if (at == behind) found.far = index_->mask(order_[j]).data();
    }
    return found;
  }

  const LeafIndex* index_;
  int axis_;
  std::vector<uint32_t> order_;
  std::vector<Across> across_;  // leaf pairs for the current shift, in that order
  int leavesApart_ = -1;        // the current shift, in leaves; -1: none
};

}  // namespace

std::array<std::optional<double>, 3> correlationLengths(const LeafIndex& index,
                                                        const Domain& domain,
                                                        Interrupter* interrupter) {
  std::array<std::optional<double>, 3> lengths;
  if (index.voxelCount() == 0) return lengths;
  const double share = double(index.voxelCount()) / double(domain.voxelCount());
  if (!(share < 1)) return lengths;
  const double target = std::exp(-1.0);
  for (int axis = 0; axis < 3; ++axis) {
    Pencils pencils(index, axis);
    const detail::DomainPairs all(domain, axis);
    const int extent = domain.box().dim()[axis];
    double before = 1;
    for (int lag = 1; 2 * lag <= extent; ++lag) {
      const double pairs = all.count(lag, interrupter);
      if (pairs == 0) break;
      const double both = double(pencils.pairs(lag, interrupter)) / pairs;
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
