// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <vector>

#include "vdb_madf/method/voxel_weights.h"
#include "vdb_madf/shapes/clumps.h"

namespace vdb_madf::detail {

/// Makes balls of different clumps end at the plane of their equal power where they overlap, as
/// clumps() says, with squared radii in units of the weights. All planes are those of the radii as
/// they come. The figures of the clumps stay.
/// @throw Interrupted.
void keepBallsApart(std::vector<Clump>& clumps, const VoxelWeights& weights,
                    Interrupter* interrupter);

}  // namespace vdb_madf::detail
