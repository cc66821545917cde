// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstdint>

#include "vdb_madf/grids/grid_types.h"
#include "vdb_madf/segmentation/segment.h"

namespace vdb_madf {

/// What the memory of segment() depends on: touched 8x8x8 leaves (active tiles counted as leaves)
/// and active voxels; and about how many of these are in structures one or two voxels thick, which
/// may all be balls and critical points.
struct ObjectSize {
  int64_t leaves = 0;
  int64_t voxels = 0;
  int64_t thin = 0;
};
ObjectSize objectSize(const MaskGrid& object);

/// Bytes that segment() needs besides the mask, at its peak. The arrays and grids are counted
/// exactly; balls, critical points and voxels without a ball are not known beforehand and enter as
/// generous shares of the object, so that the true peak is mostly a little lower (tests and the
/// benchmark compare). Nothing in it depends on the bounding box.
int64_t segmentMemory(const ObjectSize& size, const SegmentOptions& options = {});

}  // namespace vdb_madf
