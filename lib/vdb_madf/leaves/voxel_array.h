// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstddef>
#include <memory>

#include "vdb_madf/base/detail/pages.h"

namespace vdb_madf {

/// One value per object voxel, in the order of VoxelIds: the value of voxel `id` is at
/// LeafIndex::rank(id), those of a leaf follow each other from LeafIndex::firstRank(leaf) on.
/// Uninitialized when made.
template <typename T>
class VoxelArray {
 public:
  /// Readable padding after the last value, so that SIMD loads may overrun it.
  static constexpr size_t kSlack = 16;

  VoxelArray() = default;
  explicit VoxelArray(size_t size)
      : values_(static_cast<T*>(detail::allocatePages((size + kSlack) * sizeof(T)))), size_(size) {}
  T* data() { return values_.get(); }
  const T* data() const { return values_.get(); }
  size_t size() const { return size_; }
  T& operator[](size_t rank) { return values_.get()[rank]; }
  const T& operator[](size_t rank) const { return values_.get()[rank]; }
  void clear() {
    values_.reset();
    size_ = 0;
  }

 private:
  struct Free {
    void operator()(T* values) const { detail::freePages(values); }
  };
  std::unique_ptr<T, Free> values_;
  size_t size_ = 0;
};

}  // namespace vdb_madf
