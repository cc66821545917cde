// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstdint>

namespace vdb_madf::detail {

/// Cubes in the place of voxels, along one axis: voxel i takes the lengths from i voxelEdge() to
/// (i + 1) voxelEdge(), and cube j likewise, from one corner on.
class CubesAlong {
 public:
  /// The edges in any unit of length. Their ratio becomes a fraction of numbers up to 2^20: the
  /// ratio itself if it is one, to 1e-13.
  /// @throw InvalidInput if it lies beyond 256, either way
  CubesAlong(double voxelEdge, double cubeEdge);

  // The edges have no common factor, so that all lengths are whole numbers.
  int64_t voxelEdge() const { return voxel_; }
  int64_t cubeEdge() const { return cube_; }

  /// How many cubes stand for so many voxels, from the corner on: the last one is there if at least
  /// half of it is needed. @throw InvalidInput if that is none, or more than kMaxExtent.
  int countFor(int64_t voxels) const;
  /// The voxel whose center is nearest to that of a cube; of two the lower.
  int64_t nearestVoxel(int64_t cube) const;

 private:
  int64_t voxel_ = 1, cube_ = 1;
};

/// @throw InvalidInput if so many voxels are more than a grid or an image is worked with, or do not
///   fit into the memory that is free.
/// @param bytes that all of them take
void checkCubes(double voxels, double bytes);

}  // namespace vdb_madf::detail
