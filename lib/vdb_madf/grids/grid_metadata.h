// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <array>
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
inline constexpr char kVoxelSizeKey[] = "madf_voxel_size_m";    ///< of cubes (double)
inline constexpr char kVoxelEdgesKey[] = "madf_voxel_edges_m";  ///< of other voxels (Vec3d)
inline constexpr char kSourceKey[] = "madf_source";      ///< where a grid comes from (string)
inline constexpr char kBoundaryKey[] = "madf_boundary";  ///< "open" or "closed": see storedBoundary
/// How labels were tracked: the shift or the kind of motion (string), and the largest number that a
/// grain has had so far (int64).
inline constexpr char kTrackKey[] = "madf_track", kLastTrackKey[] = "madf_track_last";

/// The image domain B of a grid: the box, both corners inclusive, in the metadata
/// `madf_domain_min` and `madf_domain_max` (Vec3i), a region besides in `madf_region`
/// (detail/region_metadata.h). Absent: unknown.
/// @throw InvalidInput if only one of the two corners is there, min > max, or the region that a
///   file names is not there.
std::optional<Domain> storedDomain(const openvdb::MetaMap& metadata);
void setDomain(openvdb::MetaMap& metadata, const Domain& domain);
/// The box of the domain; where that is unknown, of the active voxels.
CoordBBox boxOf(const openvdb::GridBase& grid);
/// The name of the grid that holds the region in a file; empty if the domain is none.
std::string regionName(const openvdb::MetaMap& metadata);
/// True if `grid` is the one that holds, in their file, the region of another of the grids.
bool isRegion(const openvdb::GridBase& grid, const std::vector<openvdb::GridBase::Ptr>& grids);

/// Physical voxel size: metadata `madf_voxel_size_m` (double), of voxels that are no cubes
/// `madf_voxel_edges_m` (Vec3d: x, y, z), and the unit of the transform in `madf_length_unit`.
/// Absent: no physical size, one voxel is one unit.
std::optional<VoxelSize> storedVoxelSize(const openvdb::MetaMap& metadata);
/// Sets the metadata alone.
void setStoredVoxelSize(openvdb::MetaMap& metadata, const std::optional<VoxelSize>& size);
/// Sets the metadata and the grid's linear transform: world = index * size along each axis, so that
/// the world position of voxel (i,j,k) is its center. Without a size the transform is the identity.
void setVoxelSize(openvdb::GridBase& grid, const std::optional<VoxelSize>& size);

/// Sets the grid's transform alone, for edges > 0 along x, y and z in an unknown unit.
void setProportions(openvdb::GridBase& grid, const std::array<double, 3>& edges);

/// True if voxels are cubes along the axes of the world, mirrored or not: edges differ by at most
/// 0.1 %.
bool hasCubicVoxels(const openvdb::GridBase& grid);
/// For what does not know other voxels yet. \p what: begins the message, as in "measuring".
/// @throw InvalidInput for boxes along the axes that are no cubes
void requireCubicVoxels(const openvdb::GridBase& grid, const std::string& what);
/// True if voxels are boxes along the axes of the world, mirrored or not. Of other grids readVdb()
/// gives none unless it is told to.
bool hasVoxelsAlongAxes(const openvdb::GridBase& grid);

/// A truth value, number or text of metadata; none for other types.
using MetadataValue = std::variant<bool, int64_t, double, std::string>;
std::optional<MetadataValue> plainValue(const openvdb::Metadata& metadata);

/// Copies all metadata but the name, and the transform, from one grid to another.
void copyMetadata(const openvdb::GridBase& from, openvdb::GridBase& to);

/// Copies domain, voxel size, transform, `madf_source` and `madf_boundary` from one grid to
/// another, and to labels how they were tracked.
void copyProvenance(const openvdb::GridBase& from, openvdb::GridBase& to);

}  // namespace vdb_madf
