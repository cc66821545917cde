// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "vdb_madf/grids/grid_types.h"

namespace vdb_madf {

/// The metric of the method on voxels that need not be cubes:
///   |d|^2 = x dx^2 + y dy^2 + z dz^2  of a difference d in voxels,
/// with integer weights in the ratio of the squared edges. So squared distances stay exact
/// integers. They are in units of (edge along an axis)^2 / (weight of the axis), which is the same
/// for all axes: voxels squared for cubes, 1:1:1.
struct VoxelWeights {
  int32_t x = 1, y = 1, z = 1;

  constexpr int32_t operator[](int axis) const { return axis == 0 ? x : axis == 1 ? y : z; }
  constexpr bool operator==(const VoxelWeights& o) const {
    return x == o.x && y == o.y && z == o.z;
  }
  constexpr bool operator!=(const VoxelWeights& o) const { return !(*this == o); }
  constexpr int32_t least() const { return x < y ? (x < z ? x : z) : (y < z ? y : z); }
  /// "25:25:144"
  std::string toString() const;
};

/// Do all squared distances in an object of that extent (of its bounding box, in voxels) fit in 32
/// bits? Its rows end with the leaf nodes that hold them, so other weights than 1:1:1 need
///   x (nx + 14)^2 + y (ny + 14)^2 + z (nz + 14)^2 < 2^31.
/// 1:1:1 fits any object (kMaxExtent).
bool fitWeights(const VoxelWeights& weights, const Coord& extent);

/// @throw InvalidInput unless the weights are positive and fit.
void checkWeights(const VoxelWeights& weights, const Coord& extent);

/// Weights for the edges of a voxel, and the largest relative error of a squared length under them,
/// against that along the shortest edge.
struct WeightsOfEdges {
  VoxelWeights weights;
  double error = 0;
};

/// The weights that an object of that extent gets, in any unit of length:
/// - 1:1:1 if the edges differ by a factor of at most kMaxEdgeRatio: cubes;
/// - else exact ones, in lowest terms, if the edges are decimal numbers of up to nine digits and
///   these weights fit (0.5 x 0.5 x 1.2: 25:25:144);
/// - else, among those with the weight q = 1, 2, 3, ... of the shortest edge and the nearest
///   integers for the others, the first whose error is at most 1e-6;
/// - or, where those do not fit, the ones of least error that do.
/// The same for the same edges and extent, on every machine.
/// @throw InvalidInput if an edge is not positive, or the least error exceeds 1 %.
WeightsOfEdges weightsOfEdges(const std::array<double, 3>& edges, const Coord& extent);

/// The edges of a grid's voxels along x, y, z in the unit of its transform, without sign.
/// @throw InvalidInput if voxels are turned, sheared or differ from place to place.
std::array<double, 3> voxelEdges(const openvdb::math::Transform& transform);

/// The weights under which a grid was made: metadata `madf_weights` (Vec3i), which is only there
/// where they are not 1:1:1. @throw InvalidInput if one is not positive.
VoxelWeights storedWeights(const openvdb::MetaMap& metadata);
void setWeights(openvdb::MetaMap& metadata, const VoxelWeights& weights);

}  // namespace vdb_madf
