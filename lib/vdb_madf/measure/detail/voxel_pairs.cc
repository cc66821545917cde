// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/measure/detail/voxel_pairs.h"

#include <algorithm>
#include <atomic>
#include <numeric>

#include "vdb_madf/base/detail/bits.h"
#include "vdb_madf/base/detail/parallel.h"
#include "vdb_madf/base/detail/simd.h"
#include "vdb_madf/leaves/detail/voxels.h"

namespace vdb_madf::detail {

namespace {

constexpr size_t kPairGrain = 1024;

/// Voxels of the leaves that have another `shift` further along the axis, 0 to 7.
VDB_MADF_KERNEL int64_t countPairs(const VoxelPairs::Across* leaves, size_t count, int axis,
                                   int shift) {
  static constexpr uint64_t kEmpty[8] = {};
  const uint64_t low = kFirstZ * ((1u << (8 - shift)) - 1);  // z from 0 to 7 - shift
  int64_t sum = 0;
  for (const VoxelPairs::Across* leaf = leaves; leaf != leaves + count; ++leaf) {
    const uint64_t *own = leaf->own, *near = leaf->near, *far = shift ? leaf->far : nullptr;
    if (!near && !far) continue;
    if (!near) near = kEmpty;
    if (!far) far = kEmpty;
    uint32_t both = 0;
    if (axis == 0) {
      for (int x = 0; x < 8 - shift; ++x) both += countBits(own[x] & near[x + shift]);
      for (int x = 8 - shift; x < 8; ++x) both += countBits(own[x] & far[x + shift - 8]);
    } else if (shift == 0) {
      for (int x = 0; x < 8; ++x) both += countBits(own[x] & near[x]);
    } else if (axis == 1) {
      for (int x = 0; x < 8; ++x)
        both += countBits(own[x] & (near[x] >> 8 * shift | far[x] << (64 - 8 * shift)));
    } else {
      for (int x = 0; x < 8; ++x)
        both += countBits(own[x] & ((near[x] >> shift & low) | (far[x] << (8 - shift) & ~low)));
    }
    sum += both;
  }
  return sum;
}

}  // namespace

VoxelPairs::VoxelPairs(const LeafIndex& index, int axis, const LeafLayers& layers)
    : index_(&index),
      axis_(axis),
      layers_(layers),
      order_(index.leafCount()),
      across_(index.leafCount()) {
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

int64_t VoxelPairs::count(int lag, Interrupter* interrupter) {
  std::atomic<int64_t> sum{0};
  parallelFor(order_.size(), kPairGrain, interrupter, [&](size_t begin, size_t end) {
    if (lag >> 3 != leavesApart_)
      for (size_t i = begin; i < end; ++i) across_[i] = across(i, lag & ~7);
    sum += atBestLevel([&]() VDB_MADF_INLINE {  // integers: any order
      return countPairs(&across_[begin], end - begin, axis_, lag & 7);
    });
  });
  leavesApart_ = lag >> 3;
  return sum;
}

VoxelPairs::Across VoxelPairs::across(size_t i, int shift) const {
  Coord target = index_->origin(order_[i]);
  Across found = {index_->mask(order_[i]).data(), nullptr, nullptr};
  if (!layers_.hold(target)) return found;
  target[axis_] += shift;
  const int behind = target[axis_] + 8;
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

}  // namespace vdb_madf::detail
