// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "vdb_madf/base/voxel_size.h"
#include "vdb_madf/grids/domain.h"
#include "vdb_madf/grids/grid_types.h"

namespace vdb_madf {

/// Keys of the metadata that grids share.
inline constexpr char kVoxelSizeKey[] = "madf_voxel_size_m";
inline constexpr char kSourceKey[] = "madf_source";      ///< where a grid comes from (string)
inline constexpr char kBoundaryKey[] = "madf_boundary";  ///< "open" or "closed": see storedBoundary

/// The image domain B of a grid: the box, both corners inclusive, in the metadata
/// `madf_domain_min` and `madf_domain_max` (Vec3i), a region besides in `madf_region`
/// (detail/region_metadata.h). Absent: unknown.
/// @throw InvalidInput if only one of the two corners is there, min > max, or the region that a file
///   names is not there.
std::optional<Domain> storedDomain(const openvdb::MetaMap& metadata);
void setDomain(openvdb::MetaMap& metadata, const Domain& domain);
/// The name of the grid that holds the region in a file; empty if the domain is none.
std::string regionName(const openvdb::MetaMap& metadata);
/// True if `grid` is the one that holds, in their file, the region of another of the grids.
bool isRegion(const openvdb::GridBase& grid, const std::vector<openvdb::GridBase::Ptr>& grids);

/// Physical voxel size: metadata `madf_voxel_size_m` (double), and the unit of the transform in
/// `madf_length_unit`. Absent: no physical size, one voxel is one unit.
std::optional<VoxelSize> storedVoxelSize(const openvdb::MetaMap& metadata);
/// Sets the metadata and the grid's linear transform: world = index * size, so that the world
/// position of voxel (i,j,k) is its centre. Without a size the transform is the identity.
void setVoxelSize(openvdb::GridBase& grid, const std::optional<VoxelSize>& size);

/// True if voxels are cubes along the axes of the world, mirrored or not: edges differ by at most
/// 0.1 %. Of other grids readVdb() gives none unless it is told to.
bool hasCubicVoxels(const openvdb::GridBase& grid);

/// A truth value, number or text of metadata; none for other types.
using MetadataValue = std::variant<bool, int64_t, double, std::string>;
std::optional<MetadataValue> plainValue(const openvdb::Metadata& metadata);

/// Copies domain, voxel size, transform, `madf_source` and `madf_boundary` from one grid to
/// another.
void copyProvenance(const openvdb::GridBase& from, openvdb::GridBase& to);

}  // namespace vdb_madf
