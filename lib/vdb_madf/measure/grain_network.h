// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "vdb_madf/base/color.h"
#include "vdb_madf/grids/grid_types.h"
#include "vdb_madf/grids/label_slabs.h"
#include "vdb_madf/measure/measure.h"

namespace vdb_madf {

/// Grains as nodes, bonds (grains that share a voxel face) as edges, each with named numbers.
struct GrainNetwork {
  /// A number of each grain, or of each bond.
  struct Column {
    std::string name;  ///< letters, digits, underscores
    std::vector<double> values;
    bool isCount = false;  ///< whole numbers
  };
  std::vector<int32_t> grains;                 ///< labels, ascending
  std::vector<openvdb::Vec3d> centers;         ///< centroids of the grains, world
  std::vector<Rgb> colors;                     ///< of the grains, by grainColors()
  std::vector<std::array<uint32_t, 2>> bonds;  ///< positions in `grains`, first < second; sorted
  std::vector<Column> grainColumns, bondColumns;
  std::string unit;             ///< of the world, "mm" or "um"; empty: the voxel size is not known
  int64_t contactsLeftOut = 0;  ///< pairs of grains with too few faces for a bond
};

/// Measures the labels (measure.h) and names the
/// numbers as the tables of `vdb_madf measure` do, without units; lengths, areas, volumes and
/// places are in world units. NaN: not known (no background; an interface too small for a
/// curvature).
///
/// Columns are those of columns.h in their order, but for the labels, which `grains` and `bonds`
/// hold. `box_min` and `box_max` are the places of the outermost voxels (their centers). Bonds have
/// two more: `face_area` (of the voxel faces: overestimates oblique bonds) and `length` (between
/// the centroids).
/// @throw InvalidInput if voxels are not along the axes of the world, or mirrored, or as measure();
///   Interrupted.
GrainNetwork grainNetwork(const Int32Grid& labels, const MeasureOptions& options = {},
                          Interrupter* interrupter = nullptr);

/// Labels in slabs are read once more than by measure().
/// @throw as above; InvalidInput if the domain is a region; what reading throws.
GrainNetwork grainNetwork(const LabelSlabs& labels, const MeasureOptions& options = {},
                          Interrupter* interrupter = nullptr);

}  // namespace vdb_madf
