// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "vdb_madf/grids/grid_types.h"
#include "vdb_madf/leaves/leaf_grid.h"

namespace vdb_madf::test {

/// A box of voxels with one value each: what the oracle works on, and what tests draw.
/// z runs fastest, so the order of the indices is the lexicographic order of the coordinates.
template <typename T>
class DenseVolume {
 public:
  DenseVolume() = default;
  explicit DenseVolume(const CoordBBox& box, T value = T())
      : box_(box),
        size_(box.empty() ? Coord(0) : box.dim()),
        values_(size_t(box.volume()), value) {}

  const CoordBBox& box() const { return box_; }
  int size() const { return int(values_.size()); }
  bool contains(const Coord& p) const { return box_.isInside(p); }

  int index(const Coord& p) const {
    const Coord d = p - box_.min();
    return (d.x() * size_.y() + d.y()) * size_.z() + d.z();
  }
  Coord coord(int index) const {
    const int yz = size_.y() * size_.z();
    return box_.min() + Coord(index / yz, index / size_.z() % size_.y(), index % size_.z());
  }

  T& operator[](int index) { return values_[size_t(index)]; }
  const T& operator[](int index) const { return values_[size_t(index)]; }
  T& operator[](const Coord& p) { return values_[size_t(index(p))]; }
  const T& operator[](const Coord& p) const { return values_[size_t(index(p))]; }
  T get(const Coord& p, T outside) const { return contains(p) ? (*this)[p] : outside; }

  bool operator==(const DenseVolume& o) const { return box_ == o.box_ && values_ == o.values_; }

 private:
  CoordBBox box_;
  Coord size_{0};
  std::vector<T> values_;
};

/// 1: object, 0: background.
using ObjectVolume = DenseVolume<uint8_t>;

/// Values on the row (x, y), along z.
template <typename T>
std::vector<T> rowOf(const DenseVolume<T>& volume, int x, int y) {
  std::vector<T> values;
  for (int z = volume.box().min().z(); z <= volume.box().max().z(); ++z)
    values.push_back(volume[Coord(x, y, z)]);
  return values;
}

/// -x, +x, -y, +y, -z, +z.
extern const std::array<Coord, 6> kSixNeighbors;

/// `dim` voxels from `origin` on.
CoordBBox boxAt(const Coord& origin, const Coord& dim);

int64_t countObject(const ObjectVolume& object);
/// The box of the object voxels; empty if there are none.
CoordBBox objectBox(const ObjectVolume& object);

/// Adds the 3 x 3 x 3 voxels around a center, as far as they are in the box.
void addBlock(ObjectVolume& object, const Coord& center);

/// The same voxels in another box, cropped or padded with background.
ObjectVolume withBox(const ObjectVolume& object, const CoordBBox& box);
ObjectVolume translated(const ObjectVolume& object, const Coord& by);

/// Which axis of the old volume becomes x, y, z, and which of the new axes are then mirrored.
struct AxisMap {
  std::array<int, 3> from{0, 1, 2};
  std::array<bool, 3> mirror{false, false, false};
  Coord operator()(const Coord& p) const;
  CoordBBox operator()(const CoordBBox& box) const;
};
template <typename T>
DenseVolume<T> permuted(const DenseVolume<T>& volume, const AxisMap& map) {
  DenseVolume<T> result(map(volume.box()));
  for (int i = 0; i < volume.size(); ++i) result[map(volume.coord(i))] = volume[i];
  return result;
}

enum class Tiles {
  none,          ///< every object voxel in a leaf
  wherePossible  ///< full 8x8x8 blocks as active tiles
};
/// The object as a grid. No metadata.
MaskGrid::Ptr toMask(const ObjectVolume& object, Tiles tiles = Tiles::none);
/// The active voxels of the grid, tiles included.
ObjectVolume toObject(const MaskGrid& mask);

/// Values on the object as an active grid, background 0.
Int32Grid::Ptr toGrid(const ObjectVolume& object, const DenseVolume<int64_t>& values);

/// Empty if the grid's active voxels are exactly the object and their values as expected, and all
/// else is inactive and 0; else the first difference.
std::string difference(const std::string& what, const Int32Grid& grid, const ObjectVolume& object,
                       const DenseVolume<int64_t>& expected);

/// '#' object, '.' background; a block of rows (y down, z across) for each x.
std::string picture(const ObjectVolume& object);
/// From such a picture: rows (z across) are separated by '/', slices (x) by '|'.
ObjectVolume fromPicture(const std::string& picture, const Coord& origin = Coord(0));

std::string toString(const Coord& p);
std::string toString(const CoordBBox& box);

}  // namespace vdb_madf::test
