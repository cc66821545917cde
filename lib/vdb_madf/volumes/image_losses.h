// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <optional>
#include <string>
#include <vector>

#include "vdb_madf/base/voxel_size.h"
#include "vdb_madf/grids/grid_types.h"

namespace vdb_madf {

// What an image file cannot hold of a volume, as notes for the user, each of which begins with the
// path; empty if nothing is lost.

/// Says that its voxels are no cubes; in MetaImage that they are cubes of 1 mm, which is what it
/// has where the size is unknown.
/// @param size unknown: there is nothing to write
std::string lostEdges(const std::string& path, bool areCubes, const std::optional<VoxelSize>& size);

/// Says where the region of a grid ends.
std::string lostRegion(const std::string& path, const openvdb::GridBase& grid);

/// Says that the boundary is closed: that there is nothing beyond the faces.
std::string lostBoundary(const std::string& path, const openvdb::GridBase& grid);

/// Says where in the scan the first voxel of a grid lies, if that is not 0,0,0, or else where its
/// center lies in the world, as of reduced labels.
std::string lostPlace(const std::string& path, const openvdb::GridBase& grid);

/// Lists what an OME-Zarr lacks, or has otherwise than a reader may think: a region, a closed
/// boundary, edges without a unit, and boxes of grains that count from voxel 0,0,0 of the scan.
std::vector<std::string> zarrLossesOf(const std::string& path, const openvdb::GridBase& labels);

/// Lists all of the first four that there are.
std::vector<std::string> lossesOf(const std::string& path, const openvdb::GridBase& grid);

}  // namespace vdb_madf
