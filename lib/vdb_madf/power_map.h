// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include "vdb_madf/leaf_index.h"

namespace vdb_madf {

/// For each p in X the ball of least power distance pi_x(p) = |p - x|^2 - D(x) among the balls
/// (x, D(x)) of the sites x; equal power: larger D, then the lexicographically smaller x.
struct PowerMap {
  VoxelArray<int32_t> power;  ///< pi(p), voxels squared; 0 outside X
  VoxelArray<VoxelId> site;   ///< Pi(p); only meaningful where power < 0
};

/// In a filtered map: an object voxel that no ball covers (least power >= 0), still without a site.
constexpr int32_t kUncovered = 1;

/// Power map of all balls (p, D(p)), p in X (paper, section 4, eq. 5). D is overwritten in place:
/// D(Pi(p)) = |p - Pi(p)|^2 - pi(p). Every object voxel gets pi(p) <= -D(p) < 0.
/// @throw Interrupted
PowerMap powerMap(const LeafIndex& index, VoxelArray<int32_t> squaredDistance,
                  Interrupter* interrupter = nullptr);

/// The same of some balls only: `negativeRadii` holds -D(x) at the sites, kUncovered at the other
/// object voxels, 0 outside. Voxels that no ball covers stay kUncovered.
///
/// Separable lower envelopes (Coeurjolly & Montanvert 2007) along z, y, x. They stay within the
/// runs of X, exactly: if pi_x(p) < 0 the path x -> z -> y -> p lies in the open ball (x, D(x)),
/// which holds no background.
void sweepPower(const LeafIndex& index, PowerMap& map, Interrupter* interrupter = nullptr);

/// D(Pi(p)) of a voxel that has a site.
inline int32_t siteSquaredRadius(const LeafIndex& index, const PowerMap& map, VoxelId voxel) {
  const Coord d = index.coord(voxel) - index.coord(map.site[voxel]);
  return d.x() * d.x() + d.y() * d.y() + d.z() * d.z() - map.power[voxel];
}

}  // namespace vdb_madf
