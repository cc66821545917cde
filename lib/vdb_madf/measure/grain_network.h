// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "vdb_madf/grids/grid_types.h"

namespace vdb_madf {

/// Grains as nodes, bonds (grains that share a voxel face) as edges, each with named numbers.
struct GrainNetwork {
  struct Column {
    std::string name;  ///< letters, digits, underscores
    std::vector<double> values;
  };
  std::vector<int32_t> grains;                 ///< labels, ascending
  std::vector<openvdb::Vec3d> centers;         ///< centroids of the grains, world
  std::vector<std::array<uint32_t, 2>> bonds;  ///< positions in `grains`, first < second; sorted
  std::vector<Column> grainColumns, bondColumns;
};

/// Measures the labels (measure.h: domain and boundary are what the grid says) and names the
/// numbers as the tables of `vdb_madf measure` do, without units; lengths, areas, volumes and
/// places are in world units. NaN: not known (no background; an interface too small for a
/// curvature).
///
/// Of grains: `voxels`, `volume`, `equivalent_diameter`, `coordination`, `representative_x`, `_y`,
/// `_z`, `inscribed_radius`, `area`, `free_area`, `shared_area`, `cut_area`, `sphericity`,
/// `axis1_length` and `axis1_x`, `_y`, `_z` to `axis3...`, `aspect_2_to_1`, `aspect_3_to_2`,
/// `box_min_x` ..., `box_max_x` ... (voxels), `at_domain_face` (0 or 1).
/// Of bonds: `faces` (shared voxel faces), `face_area` (theirs: overestimates oblique bonds),
/// `center_x`, `_y`, `_z` (mean of the centres of the faces), `area`, `radius`, `normal_x`, `_y`,
/// `_z`, `distance`, `cos_alpha`, `flatness`, `patches`, `curvature_points`, `mean_curvature`,
/// `mean_curvature_sd`, `gaussian_curvature`, `gaussian_curvature_sd`, `curvature_residual`,
/// `length` (between the centroids).
/// @throw InvalidInput if the transform is not linear with cubic voxels, or as measure();
///   Interrupted.
GrainNetwork grainNetwork(const Int32Grid& labels, Interrupter* interrupter = nullptr);

}  // namespace vdb_madf
