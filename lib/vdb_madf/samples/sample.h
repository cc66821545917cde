// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <memory>

#include "vdb_madf/base/interrupter.h"
#include "vdb_madf/grids/grid_types.h"

namespace vdb_madf {

namespace detail {
class Bodies;
}

/// A synthetic object in [0, size - 1], with its domain in the metadata, and in `madf_source` the
/// command that makes it. The same options give the same bits on every machine and for any number
/// of threads. Lengths are in voxels; size is 1 to 26754 along each axis, radii are 0.5 or more.
///
/// Where options have a `voxelSize`, voxels need not be cubes. All lengths, and the size, are then
/// in units of the shortest edge, and the bodies are those that the same options make of cubes of
/// that edge. The box has as many voxels along an axis as cover it, so the domain is not the size:
/// voxel i has its center at (i + 1/2) e - 1/2, e its edge along that axis, where cube i has it at
/// i. It belongs to the object, and to a grain, by its center.
///
/// Each generator @throw InvalidInput for options out of range, or that cannot be met, such as a
/// size of less than a voxel; Interrupted.
struct Sample {
  MaskGrid::Ptr object;  ///< named `object`
  /// Named `truth`, the object's topology but for specks of noise (scan.h): labels 1..N of the true
  /// grains, numbered by the centers of their balls or particles (x, then y, then z); those of a
  /// list by their order in it. Null where there is no truth.
  Int32Grid::Ptr truth;
  /// What grayValues() shows (scan.h), of spheres, balls, sintered, particles and beds.
  std::shared_ptr<const detail::Bodies> bodies = nullptr;
};

}  // namespace vdb_madf
