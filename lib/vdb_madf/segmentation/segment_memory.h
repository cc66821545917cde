// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstdint>

#include "vdb_madf/grids/grid_types.h"
#include "vdb_madf/segmentation/segment.h"

namespace vdb_madf {

/// What the memory of segment() and of measure() depends on. But for the first two, which are
/// counted, these are totals of the whole object as far as they are known.
struct ObjectSize {
  int64_t leaves = 0;  ///< touched 8x8x8 ones, active tiles counted as leaves
  int64_t voxels = 0;  ///< active ones
  int64_t cavities = 0;
  int64_t balls = 0;
  int64_t ballLeaves = 0;  ///< leaf nodes with a ball, if balls are kept
  int64_t keptBalls = 0;   ///< that the filter leaves
  int64_t points = 0;      ///< critical ones
  int64_t edges = 0;       ///< of the graph of their manifolds
  int64_t grains = 0;      ///< as merged
  int64_t parts = 0;       ///< of grains, one in each leaf node that they lie in
  int64_t bonds = 0;       ///< pairs of grains that touch
};

/// The size that no object of as many voxels exceeds: each of them a ball, a critical point and a
/// grain. Takes next to no time.
ObjectSize sizeAtMost(const MaskGrid& object, const SegmentOptions& options = {});

/// The size as a sample tells: eight blocks of 64^3 voxels, spread evenly over the leaf nodes, are
/// segmented with these options, and two standard errors are added; what is not much larger is
/// segmented as a whole. The same for the same object and options.
/// @throw InvalidInput as segment()
ObjectSize sampledSize(const MaskGrid& object, const SegmentOptions& options = {});

/// Bytes that segment() needs besides the mask, at its peak: arrays and grids are counted, and what
/// the other numbers of the size take was measured (`tests/memory` compares). Nothing in it depends
/// on the bounding box.
int64_t segmentMemory(const ObjectSize& size, const SegmentOptions& options = {});

/// Bytes that measure() and its tables need after that, at their peak, with the labels' grid.
int64_t tablesMemory(const ObjectSize& size, const SegmentOptions& options = {});

}  // namespace vdb_madf
