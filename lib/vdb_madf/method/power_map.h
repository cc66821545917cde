// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include "vdb_madf/leaves/leaf_index.h"
#include "vdb_madf/leaves/voxel_array.h"
#include "vdb_madf/method/squared_distance.h"

namespace vdb_madf {

/// The ball of least power distance for each p in X (arrays by rank, see leaf_index.h):
///   pi_x(p) = |p - x|^2 - D(x)
/// among the balls (x, D(x)) of the sites x. At equal power the larger D wins, then the
/// lexicographically smaller x.
struct PowerMap {
  VoxelArray<int32_t> power;                         ///< pi(p)
  VoxelArray<VoxelId> site;                          ///< Pi(p); only meaningful where power < 0
  VoxelWeights weights{};                            ///< of |p - x|^2
  std::shared_ptr<const detail::Passage> passage{};  ///< that of the distances
  std::shared_ptr<const detail::ForeignSites> foreign{};  ///< likewise
};

/// Marks an object voxel of a filtered map that no ball covers (least power >= 0) and that has no
/// site yet.
constexpr int32_t kUncovered = 1;

/// Power map of all balls (p, D(p)), p in X (paper, section 4, eq. 5), with the weights of the
/// distance. D is overwritten in place:
/// D(Pi(p)) = |p - Pi(p)|^2 - pi(p). Every object voxel gets pi(p) <= -D(p) < 0.
/// @throw Interrupted
PowerMap powerMap(const LeafIndex& index, SquaredDistance distance,
                  Interrupter* interrupter = nullptr);

}  // namespace vdb_madf
