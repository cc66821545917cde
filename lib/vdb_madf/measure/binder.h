// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstdint>
#include <vector>

namespace vdb_madf {

/// The binder (ice, cement) between two grains; lengths in voxels, of unequal ones in their
/// shortest edge (Measurements::edges).
struct Bridge {
  int32_t first = 0, second = 0;  ///< labels, first < second
  bool bonded = false;            ///< the grains have a bond, too
  int64_t voxels = 0;
  double volume = 0;
  /// Area of the bridge where it is as far from both grains: between the voxels that are nearer to
  /// the one and those nearer to the other. Without the bond.
  double section = 0;
  double sectionRadius = 0;                ///< that of the disc of this area
  double firstCover = 0, secondCover = 0;  ///< areas of the two grains that it covers
  double firstShare = 0, secondShare = 0;  ///< these / free area of the grain
};

/// A third phase in the pores. A voxel of it belongs to the cell of its nearest grain
/// (detail/voronoi_cells.h), and within the cell to the neighbor that it reaches in the fewest
/// steps across faces through binder, of several to that of the smallest label: it is part of the
/// bridge of these two.
struct Binder {
  std::vector<Bridge> bridges;  ///< by first, then second
  double volume = 0;            ///< of all binder in the domain, outside of grains
  double looseVolume = 0;       ///< of what reaches no second grain: coats
};

}  // namespace vdb_madf
