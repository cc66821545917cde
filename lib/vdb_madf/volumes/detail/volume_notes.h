// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "vdb_madf/grids/domain.h"
#include "vdb_madf/volumes/volume.h"

namespace vdb_madf::detail {

/// Some edge differs by more than 0.1 % (kMaxEdgeRatio).
bool haveOtherEdges(const VoxelSize& a, const VoxelSize& b);

/// "8.5 um", "0.5 x 0.5 x 1.2 um", to four digits.
std::string voxelText(const VoxelSize& size);

/// Notes that the options have another voxel size than the file: mostly a slip of the unit, or
/// another sample's size.
void noteVoxelSize(const std::string& path, const std::optional<VoxelSize>& ofFile,
                   const VolumeOptions& options);

/// Notes that voxels of other proportions are given than the file has, which does not say how large
/// its voxels are.
void noteProportions(const std::string& path, const std::array<double, 3>& edges,
                     const VolumeOptions& options);
/// Notes these two of a grid, and of a segmentation that it was made in its own voxels.
void noteVoxelSize(const std::string& path, const openvdb::GridBase& grid,
                   const VolumeOptions& options);

/// Notes along which axes a box ("crop", "domain") reaches beyond a scan, and what that means. A
/// side that is farther away than scans are long is one that nobody gave.
void noteBeyond(const std::string& path, const std::string& what, const CoordBBox& box,
                const CoordBBox& scan, const std::string& meaning, const VolumeOptions& options);

/// Refuses labels and masks with voxels outside of a domain, which files without such voxels would
/// lose. @throw InvalidInput
void checkWithinDomain(const openvdb::GridBase& grid, const Domain& domain);

/// Gives a grid the domain of the options, if they have one; notes where it reaches beyond its own,
/// and that a region goes. @throw InvalidInput if it does not hold the grid, and nothing is cropped
void giveDomain(openvdb::GridBase& grid, const std::string& path, const VolumeOptions& options);

/// Gives a grid the voxel size of the options, if they have one. Its first voxel stays where it is,
/// in edges of voxels: that of reduced labels, or of a part of a scan.
void giveVoxelSize(openvdb::GridBase& grid, const VolumeOptions& options);

/// Notes how many voxels of a kind lie outside of the region, if any do.
void noteLeftOut(const std::string& path, int64_t voxels, const char* kind,
                 const VolumeOptions& options);

}  // namespace vdb_madf::detail
