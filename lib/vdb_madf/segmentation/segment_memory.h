// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstdint>

#include "vdb_madf/grids/grid_types.h"
#include "vdb_madf/segmentation/segment.h"

namespace vdb_madf {

/// What the memory of segment() depends on.
struct ObjectSize {
  int64_t leaves = 0;  ///< touched 8x8x8 ones, active tiles counted as leaves
  int64_t voxels = 0;  ///< active ones
  /// About how many of these may be balls and critical points: detail::countThin(), as those of
  /// structures one or two voxels thick.
  int64_t thin = 0;
  int64_t pieces = 0;  ///< 6-connected ones within leaves, of leaves with thin structures
  /// About how many small pieces touch nothing else, and are grains by themselves: as many as lie
  /// inside of leaves, in proportion.
  int64_t specks = 0;
};
ObjectSize objectSize(const MaskGrid& object);

/// Bytes that segment() needs besides the mask, at its peak. The arrays and grids are counted
/// exactly; balls, critical points and voxels without a ball are not known beforehand and enter as
/// generous shares of the object, so that the true peak is mostly a little lower (tests and the
/// benchmark compare). Nothing in it depends on the bounding box.
int64_t segmentMemory(const ObjectSize& size, const SegmentOptions& options = {});

/// Bytes that measure() and its tables need after that, at their peak, with the labels' grid.
int64_t tablesMemory(const ObjectSize& size, const SegmentOptions& options = {});

}  // namespace vdb_madf
