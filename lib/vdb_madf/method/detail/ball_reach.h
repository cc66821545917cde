// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include "vdb_madf/grids/domain.h"
#include "vdb_madf/method/critical_point.h"
#include "vdb_madf/method/voxel_weights.h"

namespace vdb_madf::detail {

/// Is some voxel outside of the domain nearer to a point than its D? If all is in a plane, voxels
/// of that plane alone count. In a region that takes time for the parts of its tree that the ball
/// meets and that are neither all in it nor all outside.
bool reachesOut(const CriticalPoint& point, const Domain& domain, const VoxelWeights& weights);

}  // namespace vdb_madf::detail
