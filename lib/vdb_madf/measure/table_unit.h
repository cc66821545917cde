// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <array>
#include <optional>
#include <string>

#include "vdb_madf/measure/measure.h"

namespace vdb_madf {

/// Refuses what TableUnit would, before there are measures.
/// @throw InvalidInput for another unit than "", "mm" and "um", and for these two without a size
void requireTableUnit(const std::string& wanted, const std::optional<VoxelSize>& size);

/// The unit of length of tables and charts, and what a voxel is in it.
struct TableUnit {
  std::string name = "voxel";            ///< or "mm", "um"
  std::array<double, 3> voxel{1, 1, 1};  ///< its edges; of unknown ones 1 is the shortest
  double length = 1;                     ///< the shortest of them
  openvdb::Vec3d edges{1, 1, 1};         ///< what places, which are index coordinates, are times

  /// @param wanted "mm" or "um"; empty: the unit of the voxel size, voxels if there is none
  /// @throw InvalidInput as requireTableUnit()
  explicit TableUnit(const Measurements& measured, const std::string& wanted = "");

  double area() const { return length * length; }
  double volume() const { return length * length * length; }
};

/// A sentence on labels whose voxel 0,0,0 does not have its center at 0,0,0 of the world, such as
/// those of coarser voxels than those of their scan: places in the tables count from there. Of
/// others, and of voxels of unknown size, it is empty.
std::string noteOnPlaces(const openvdb::GridBase& labels);

}  // namespace vdb_madf
