// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <memory>

#include "vdb_madf/leaves/leaf_index.h"
#include "vdb_madf/leaves/voxel_array.h"
#include "vdb_madf/method/boundary.h"
#include "vdb_madf/method/voxel_weights.h"

namespace vdb_madf {

namespace detail {
class Passage;
class ForeignSites;
}  // namespace detail

/// D of each voxel of the object, by rank, and what later stages have to know of it.
struct SquaredDistance {
  VoxelArray<int32_t> values;  ///< D >= 1
  int32_t largest = 0;         ///< 0 if X is empty
  VoxelWeights weights{};      ///< whose squared distances these are
  /// What the sweeps of the power map have to pass; null where the object is all of it, as it is
  /// unless an open domain is a region.
  std::shared_ptr<const detail::Passage> passage{};
  /// The balls beyond the cuts of a slab that take part in its power map; null if there are none.
  std::shared_ptr<const detail::ForeignSites> foreign{};
};

/// Exact squared Euclidean distance D(p) = min |p - q|^2 over background voxels q, for p in X.
/// Separable passes (Meijster et al. 2000) along x, y, z, each within the runs of X in its rows: a
/// background voxel ends whatever lies beyond it, so the sweeps never leave X. In an open region
/// they also pass the unknown voxels around X (detail/passage.h).
/// With weights |p - q|^2 is that of voxel_weights.h, and the same holds: it is a sum over the axes
/// that grows with every step away along one.
/// @throw InvalidInput if there is no background (X fills an open domain), or as checkWeights();
///   Interrupted.
SquaredDistance squaredDistance(const LeafIndex& index, const Obstacles& obstacles,
                                const VoxelWeights& weights = {},
                                Interrupter* interrupter = nullptr);

}  // namespace vdb_madf
