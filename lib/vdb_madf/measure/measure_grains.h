// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "vdb_madf/grids/grid_types.h"
#include "vdb_madf/measure/grain_shape.h"
#include "vdb_madf/measure/gray_values.h"
#include "vdb_madf/measure/recurrence.h"
#include "vdb_madf/method/grain_lives.h"

namespace vdb_madf {

/// Three orthogonal directions and what is measured along them, in descending order. The largest
/// component of each direction is positive.
struct Principal {
  std::array<openvdb::Vec3d, 3> axes;
  std::array<double, 3> values{};
};

/// A tensor of second order, symmetric.
struct SymmetricTensor {
  std::array<double, 6> components{};  ///< xx, yy, zz, xy, xz, yz
  Principal principal;

  double at(int row, int column) const {
    return components[size_t(row == column ? row : row + column + 2)];
  }
};

/// The part of the domain to which no other grain is nearer (detail/voronoi_cells.h).
struct GrainCell {
  double volume = 0;          ///< with the grain itself
  int neighbors = 0;          ///< grains whose cells share a voxel face with it
  bool atDomainFace = false;  ///< it ends at the domain, and is too small
};

/// Where the wall of an open domain cuts a grain: all voxel faces of one side.
struct GrainCut {
  int axis = 0;          ///< of their normals
  bool isUpper = false;  ///< the domain ends above them
  double area = 0;
  openvdb::Vec3d centroid{0, 0, 0};  ///< of the faces' centers, index coordinates
};

/// A grain; lengths in voxels, of unequal ones in their shortest edge (Measurements::edges).
struct GrainMeasures {
  int32_t id = 0;  ///< its label
  int64_t voxels = 0;
  double volume = 0;                 ///< = voxels, of cubes
  openvdb::Vec3d centroid{0, 0, 0};  ///< of the voxels' centers, index coordinates
  CoordBBox box;                     ///< inclusive
  /// A voxel has a face neighbor outside the domain or, if that is unknown, the box of all grains.
  bool atDomainFace = false;
  /// The voxel of largest squared distance to the background, of several the first; none without
  /// background. Its distance is the inscribed radius.
  std::optional<openvdb::Coord> representative;
  double inscribedRadius = 0;
  double equivalentDiameter = 0;  ///< of the ball of this volume
  double freeArea = 0;            ///< towards the background
  double sharedArea = 0;          ///< towards other grains, be there a bond or too few faces for it
  double cutArea = 0;             ///< voxel faces at the wall of an open domain; in no other area
  std::vector<GrainCut> cuts;     ///< what it is made of, by axis, the lower side first
  /// Area of the ball of this volume / area, the cut one included; none for grains of fewer than
  /// 27 voxels, whose area is too uncertain.
  std::optional<double> sphericity;
  /// Axes of inertia and the lengths (not half lengths) of the axes of the ellipsoid that has the
  /// grain's second moments, voxels being boxes.
  Principal ellipsoid;
  int coordination = 0;  ///< number of bonds
  // What was not asked for is none, or 0.
  std::optional<GrainShape> shape;
  std::optional<GrayValues> gray;  ///< at its voxels
  double edgeWeight = 0;           ///< see edge_weights.h
  std::optional<GrainCell> cell;
  std::optional<Recurrence> recurrence;  ///< when the scan was segmented by other choices
  GrainLife life;                        ///< see measure_stability.h

  double totalArea() const { return freeArea + sharedArea; }
  double solidity() const { return volume / shape.value().convexVolume; }
  double localSolidFraction() const { return volume / cell.value().volume; }
};

/// Where in a list, ascending by label, the grain of a label is, or the first of a larger one.
inline size_t rowOf(const std::vector<GrainMeasures>& grains, int32_t label) {
  return size_t(
      std::lower_bound(grains.begin(), grains.end(), label,
                       [](const GrainMeasures& grain, int32_t id) { return grain.id < id; }) -
      grains.begin());
}

}  // namespace vdb_madf
