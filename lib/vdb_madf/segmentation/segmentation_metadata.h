// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include "vdb_madf/method/boundary.h"
#include "vdb_madf/segmentation/segment.h"

namespace vdb_madf {

/// Writes how a segmentation was made onto one of its grids: `madf_version`, `madf_gamma`,
/// `madf_boundary` ("open", "closed"), `madf_theta`, `madf_merge`, `madf_adjacency`,
/// `madf_fill_holes`, `madf_delta`, `madf_tidy`, and the counts `madf_object_voxels`,
/// `madf_cavities`, `madf_cavity_voxels`, `madf_medial_balls`, `madf_kept_balls`,
/// `madf_critical_points`, `madf_grains`, `madf_largest_squared_distance`, `madf_leaves` (int64);
/// and `madf_weights`, if they are not 1:1:1 (voxel_weights.h). With MergeMode::score
/// `madf_strictness` stands in the place of theta, adjacency and delta. With minGrain there is
/// `madf_min_grain` (int64), too.
void describeSegmentation(openvdb::GridBase& grid, const SegmentOptions& options,
                          const SegmentationRecord& record);

/// Replaces what another merging changes: the mode and its options, tidy and the number of grains.
void describeMerging(openvdb::GridBase& grid, const MergeOptions& options, int tidy,
                     int64_t grains);

/// Replaces the same by a merging of one's own: `madf_merge` is "own"; the options of modes
/// go.
void describeOwnMerging(openvdb::GridBase& grid, int tidy, int64_t grains);

/// How manifolds were merged.
struct StoredMerging {
  MergeOptions options;
  int tidy = 0;  ///< rounds
};
/// What describeMerging() wrote; absent: a grid does not say it, or its merging was one's own.
std::optional<StoredMerging> storedMerging(const openvdb::MetaMap& metadata);

/// What was edited (string; edits/edit_labels.h): the texts of the edits, joined by "; ".
inline constexpr char kEditsKey[] = "madf_edits";

/// Brings the counts up to date of a grid some of whose grains were joined, divided or dropped: the
/// grains, and if voxels went the voxels and leaves; counts of balls, critical points and cavities
/// then go, for they are those of the whole object. A grid without counts gets none.
void updateCounts(openvdb::GridBase& grid, int64_t grains, bool voxelsWent);

/// False if a grid no longer has the voxels that were segmented, as a crop: its counts tell.
bool hasSegmentedVoxels(const openvdb::GridBase& grid);

/// The number of object voxels, and of grains, that a grid says it has.
std::optional<int64_t> objectVoxelCount(const openvdb::GridBase& grid);
std::optional<int64_t> grainCount(const openvdb::GridBase& grid);

const char* toString(MergeMode mode);
const char* toString(Adjacency adjacency);

}  // namespace vdb_madf
