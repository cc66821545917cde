// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "vdb_madf/grid_types.h"

namespace vdb_madf {

/// Position of a voxel in a LeafIndex: leaf * 512 + offset, offset = x*64 + y*8 + z within the
/// leaf.
using VoxelId = uint32_t;

/// One value per voxel of each leaf of a LeafIndex, at VoxelId; uninitialised when made. Every
/// stage leaves 0 at the voxels outside the object.
template <typename T>
class VoxelArray {
 public:
  VoxelArray() = default;
  explicit VoxelArray(size_t size) : values_(new T[size]), size_(size) {}
  T* data() { return values_.get(); }
  const T* data() const { return values_.get(); }
  size_t size() const { return size_; }
  T& operator[](size_t i) { return values_[i]; }
  const T& operator[](size_t i) const { return values_[i]; }
  void clear() {
    values_.reset();
    size_ = 0;
  }

 private:
  std::unique_ptr<T[]> values_;
  size_t size_ = 0;
};

/// The topology of the object X: its 8x8x8 leaves sorted by origin (x, then y, then z), their masks
/// and their six neighbours. The one place that knows the topology; every stage works on it.
class LeafIndex {
 public:
  static constexpr uint32_t kNone = 0xffffffffu;  ///< no neighbour
  /// 32-bit voxel ids end here: 8,388,607 leaves.
  static constexpr size_t kMaxLeaves = 0xffffffffu / 512;
  /// Squared distances fit in 32 bits up to this many voxels a side: 3 n^2 < 2^31.
  static constexpr int kMaxExtent = 26754;
  static constexpr int kMaxCoordinate = (1 << 30) - 1;

  /// Bit y*8 + z of word x is voxel (x, y, z) of the leaf.
  using Mask = std::array<uint64_t, 8>;
  /// -x, +x, -y, +y, -z, +z; kNone where there is no leaf.
  using Neighbors = std::array<uint32_t, 6>;

  LeafIndex() = default;
  /// Active voxels of the mask, active tiles included.
  /// @throw InvalidInput if there are more than kMaxLeaves leaves (tiles counted as leaves), the
  ///   object is longer than kMaxExtent along an axis, or has coordinates beyond kMaxCoordinate.
  explicit LeafIndex(const MaskGrid& object);

  size_t leafCount() const { return origins_.size(); }
  size_t idCount() const { return origins_.size() * 512; }  ///< size of a VoxelArray
  int64_t voxelCount() const { return voxelCount_; }        ///< |X|
  /// Of the active voxels; empty if there are none.
  const CoordBBox& boundingBox() const { return boundingBox_; }

  const Coord& origin(size_t leaf) const { return origins_[leaf]; }
  const Mask& mask(size_t leaf) const { return masks_[leaf]; }
  const Neighbors& neighbors(size_t leaf) const { return neighbors_[leaf]; }

  Coord coord(VoxelId id) const {
    const Coord& o = origins_[id >> 9];
    return {o.x() + int(id >> 6 & 7), o.y() + int(id >> 3 & 7), o.z() + int(id & 7)};
  }

 private:
  std::vector<Coord> origins_;
  std::vector<Mask> masks_;
  std::vector<Neighbors> neighbors_;
  CoordBBox boundingBox_;
  int64_t voxelCount_ = 0;
};

/// An Int32 grid with the topology of X and the array's values; background 0, inactive elsewhere.
/// @throw Interrupted
Int32Grid::Ptr toGrid(const LeafIndex& index, const VoxelArray<int32_t>& values,
                      const std::string& name, Interrupter* interrupter = nullptr);
/// The same of table[values[id]].
Int32Grid::Ptr toGrid(const LeafIndex& index, const VoxelArray<uint32_t>& values,
                      const std::vector<int32_t>& table, const std::string& name,
                      Interrupter* interrupter = nullptr);

}  // namespace vdb_madf
