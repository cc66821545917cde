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

/// Columns of grains: `voxels`, `volume` (world), `equivalent_diameter` (of the ball of that
/// volume, world), `coordination` (number of bonds). Of bonds: `faces` (shared voxel faces),
/// `face_area` (theirs, world: overestimates the area of oblique bonds), `length` (between the
/// centroids, world), `center_x`, `_y`, `_z` (mean of the centres of the faces, world). One pass
/// over the leaves; labels are the active voxels (tiles included) of positive value. The same for
/// any number of threads.
/// @throw InvalidInput if the transform is not linear with cubic voxels; Interrupted.
GrainNetwork grainNetwork(const Int32Grid& labels, Interrupter* interrupter = nullptr);

/// Writes the network, whole or not at all, by ending:
/// - .vtp: VTK points with the grains' columns and Int32 `grain_id`, lines with the bonds' columns
///   and `first_grain`, `second_grain`
/// - .graphml: nodes `n<label>` with `grain_id`, x, y, z and the columns; undirected edges
/// - .csv: a table in OpenPNM's naming: pore.coords[0..2], pore.<column>, throat.conns[0..1],
///   throat.<column>; the shorter of the two lists is filled up with empty cells
/// @throw InvalidInput for another ending; IoError; Interrupted.
void writeNetwork(const std::string& path, const GrainNetwork& network,
                  Interrupter* interrupter = nullptr);
/// True if writeNetwork knows the ending.
bool isNetworkEnding(const std::string& path);

}  // namespace vdb_madf
