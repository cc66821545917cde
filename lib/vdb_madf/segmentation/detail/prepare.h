// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include "vdb_madf/method/boundary.h"
#include "vdb_madf/segmentation/segment.h"

// The decisions before the first stage, of segment() and of segmentSlabs().

namespace vdb_madf::detail {

/// @throw InvalidInput if a number is out of its range.
void checkSegmentOptions(const SegmentOptions& options);

/// Checks the options and decides what no voxel is needed for: domain, boundary, cavities, tidying.
/// \p about: its transform and metadata are those of the object.
/// @throw InvalidInput also if the boundary is open without a domain, or voxels are turned or
///   sheared
Obstacles prepare(const MaskGrid& about, const SegmentOptions& options, SegmentationRecord& record);

/// Decides the weights: those that are asked for, or those of the edges of voxels. \p body: the box
/// of the object with its cavities filled. @throw InvalidInput if none fit
void chooseWeights(const MaskGrid& about, const SegmentOptions& options, const Obstacles& obstacles,
                   const CoordBBox& body, SegmentationRecord& record);

}  // namespace vdb_madf::detail
