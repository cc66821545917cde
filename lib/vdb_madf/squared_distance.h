// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <optional>

#include "vdb_madf/grid_types.h"
#include "vdb_madf/leaf_index.h"

namespace vdb_madf {

/// What lies outside the object counts as background ...
enum class Boundary {
  automatic,  ///< open if the domain is known, else closed
  open,       ///< ... only inside the domain: a grain cut by a face of the scan is not rounded off
  closed      ///< ... everywhere
};

/// Boundary and domain, resolved: an open one has a domain.
struct Obstacles {
  bool open = false;
  CoordBBox domain;  ///< used if open
};

/// @throw InvalidInput: open without a domain, or voxels of `index` outside the domain.
Obstacles resolveBoundary(const LeafIndex& index, Boundary boundary,
                          const std::optional<CoordBBox>& domain);

struct SquaredDistance {
  VoxelArray<int32_t> values;  ///< D >= 1, voxels squared
  int32_t largest = 0;         ///< 0 if X is empty
};

/// Exact squared Euclidean distance D(p) = min |p - q|^2 over background voxels q, for p in X.
/// Separable passes (Meijster et al. 2000) along x, y, z, each within the runs of X in its rows: a
/// background voxel ends whatever lies beyond it, so the sweeps never leave X.
/// @throw InvalidInput if there is no background (X fills an open domain); Interrupted.
SquaredDistance squaredDistance(const LeafIndex& index, const Obstacles& obstacles,
                                Interrupter* interrupter = nullptr);

}  // namespace vdb_madf
