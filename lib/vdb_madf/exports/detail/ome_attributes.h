// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <array>
#include <string>
#include <utility>
#include <vector>

#include "vdb_madf/exports/detail/grain_table.h"
#include "vdb_madf/exports/ome_zarr.h"
#include "vdb_madf/labels/grain_colors.h"

namespace vdb_madf::detail {

// The metadata of OME-Zarr, as text of JSON. Source: OME-NGFF 0.4, 0.5 and 0.6.

/// Where voxels lie, in `unit`: the center of voxel (0,0,0), and edges, along x, y and z.
struct OmePlace {
  std::array<double, 3> origin{}, edges{};
  std::string unit;  ///< "micrometer"; empty: the physical size is not known
};
/// @throw InvalidInput if voxels are not along the axes of the world
OmePlace omePlaceOf(const openvdb::GridBase& grid);

/// A level: its coarse voxels are as many voxels long, and its array begins at one of them.
struct OmeScale {
  int factor = 1;
  Coord first;
};
/// The attributes of a multiscale image whose arrays are called 0, 1, 2 ... In 0.6 its coordinate
/// system is called "physical", and that of the object is also that of its labels.
std::string multiscales(const std::string& name, const OmePlace& place,
                        const std::vector<OmeScale>& scales, OmeVersion version);

/// The transformation between the coordinate systems of two images of a scene, of OME-Zarr 0.6.
/// @param paths of the images: from the first to the second
/// @param linear, shift: in voxels of the first and the second, x, y, z: p is at linear * p + shift
std::string sceneText(const std::array<std::string, 2>& paths,
                      const std::array<OmePlace, 2>& places, const openvdb::Mat3d& linear,
                      const openvdb::Vec3d& shift);

/// Colors and measures of the grains. (Written as text: as objects, they would be many times as
/// large.)
std::string imageLabel(const GrainTable& table, const GrainColors& colors, OmeVersion version);

/// A name and JSON.
using OmeMember = std::pair<std::string, std::string>;
/// The attributes of a group.
std::string omeAttributes(const std::vector<OmeMember>& members, OmeVersion version);

}  // namespace vdb_madf::detail
