// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <openvdb/Types.h>

#include <optional>

#include "vdb_madf/base/voxel_size.h"
#include "vdb_madf/grids/grid_types.h"

namespace vdb_madf::detail {

/// Where the voxels of a sample lie. The unit of length is the shortest edge of a voxel, and the
/// box begins at -1/2 along each axis, whatever its voxels: so voxel i of cubes lies at i, exactly.
class Lattice {
 public:
  /// Voxels are cubes.
  Lattice() = default;
  /// Edges are in the unit of length to nine decimals, so that it makes no difference which unit
  /// they were written in.
  explicit Lattice(const std::optional<VoxelSize>& voxelSize);

  double edge(int axis) const { return edges_[axis]; }
  const openvdb::Vec3d& edges() const { return edges_; }
  /// The center of voxel i along an axis.
  double place(int axis, int i) const { return (i + 0.5) * edges_[axis] - 0.5; }
  openvdb::Vec3d place(const Coord& p) const {
    return {place(0, p.x()), place(1, p.y()), place(2, p.z())};
  }
  /// The voxel at a place, with fractions; exact but for rounding.
  double index(int axis, double place) const { return (place + 0.5) / edges_[axis] - 0.5; }

  /// The number of voxels along each axis that cover a box of that size in the unit of length.
  /// @throw InvalidInput if one voxel is longer than the box
  Coord voxels(const Coord& size) const;
  /// Voxels with their centers in a box of places, and perhaps some around it.
  CoordBBox voxelsIn(const CoordBBox& places) const;

 private:
  openvdb::Vec3d edges_{1, 1, 1};
};

}  // namespace vdb_madf::detail
