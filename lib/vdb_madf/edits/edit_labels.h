// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstdint>
#include <vector>

#include "vdb_madf/edits/edits.h"
#include "vdb_madf/grids/grid_types.h"

namespace vdb_madf {

/// What an edit did.
struct EditResult {
  Edit edit;
  /// split: the parts, ascending, one of which has the grain's number; merge: the grain; joinBelow:
  /// those that others have joined, ascending.
  std::vector<int32_t> grains;
  int64_t droppedGrains = 0, droppedVoxels = 0;
  int64_t joinedGrains = 0;  ///< joinBelow: those that have become part of others
};

/// New labels, and what came of each edit.
struct EditedLabels {
  Int32Grid::Ptr labels;
  std::vector<EditResult> results;  ///< an entry an edit
  int64_t grainsBefore = 0, grains = 0;
  int64_t voxelsBefore = 0, voxels = 0;
};

/// Edits labels, one edit after the other: each sees what the ones before it left. Labels are the
/// active voxels, tiles included, of positive value. Grains that no edit names or drops keep their
/// voxels and numbers (but for `renumber`). Dropped voxels become background, inactive.
///
/// merge: the grains become one, whether they touch or not. split: its inverse. A grain is divided
/// into the grains of the segmentation and the parts of such that it consists of, each as it was; a
/// grain of the segmentation, or a part of one, in two: into what the last join by score made one,
/// if it was merged so, else at its weakest neck (detail/grain_parts.h).
/// A part has the number that it always has when it is one grain, if that is free: what is merged
/// and split, or split and merged, has the same labels as before, bit for bit. Otherwise it gets
/// the least number above all others; if none has the number of the divided grain, the largest gets
/// it. joinBelow: joinSmall() of method/join_small.h, for grains in the order of their numbers.
/// dropAtFaces: grains that have a voxel with a face neighbor outside the domain; if that is
/// unknown, outside the box of the grains that are left. strictness: labels that were not merged by
/// score with this one are refused.
///
/// Metadata are those of the labels; kEditsKey tells the edits after those that were there, counts
/// of a segmentation are brought up to date (updateCounts(), segmentation/segmentation_metadata.h),
/// and a graph of manifolds goes, for it is not that of edited ones.
/// @param manifold with the graph of the segmentation that the labels come from (`segment` with
///   keepManifold); for split alone
/// @throw InvalidInput that names the edit: a grain that is not there, a diameter where the size of
///   voxels is unknown, another strictness, a grain that cannot be split; without manifold or
///   graph, or if these do not fit the labels, every split; Interrupted.
EditedLabels editLabels(const Int32Grid& labels, const std::vector<Edit>& edits,
                        const Int32Grid* manifold = nullptr, Interrupter* interrupter = nullptr);

}  // namespace vdb_madf
