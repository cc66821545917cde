// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "vdb_madf/grid_types.h"

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

/// Writes the network, whole or not at all, by ending:
/// - .vtp: VTK points with the grains' columns and Int32 `grain_id`, lines with the bonds' columns
///   and `first_grain`, `second_grain`
/// - .graphml: nodes `n<label>` with `grain_id`, x, y, z and the columns; undirected edges
/// - .csv: a table in OpenPNM's naming: pore.coords[0..2], pore.<column>, throat.conns[0..1],
///   throat.<column>; the shorter of the two lists is filled up with empty cells
/// A NaN is NaN in .vtp, no entry in .graphml, an empty cell in .csv.
/// @throw InvalidInput for another ending; IoError; Interrupted.
void writeNetwork(const std::string& path, const GrainNetwork& network,
                  Interrupter* interrupter = nullptr);
/// True if writeNetwork knows the ending.
bool isNetworkEnding(const std::string& path);

}  // namespace vdb_madf
