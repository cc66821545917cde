// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstdint>

#include "vdb_madf/grids/grid_types.h"

namespace vdb_madf {

// Both work on leaf nodes: memory is some 200 bytes for each that the object touches.

/// What despeckling changed.
struct Despeckled {
  int64_t islands = 0, islandVoxels = 0;   ///< dropped
  int64_t cavities = 0, cavityVoxels = 0;  ///< filled
};

/// Drops the 6-connected components of the object with fewer than `voxels` voxels, then fills those
/// of the background within the domain: scikit-image's remove_small_objects() and
/// remove_small_holes(), whose connectivity is 1. So a cavity may reach a face of the domain;
/// without a domain one that is enclosed is filled. If no background would be left, none is filled.
/// @throw InvalidInput if the object has more than kMaxLeaves leaf nodes; Interrupted.
Despeckled despeckle(MaskGrid& mask, int64_t voxels, Interrupter* interrupter = nullptr);

/// Drops the 6-connected components of `mask` without a voxel of `seeds`, which are part of it:
/// what hysteresis leaves of the voxels above the lower threshold. @throw as above
void keepSeeded(MaskGrid& mask, const MaskGrid& seeds, Interrupter* interrupter = nullptr);

}  // namespace vdb_madf
