// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include "vdb_madf/method/detail/foreign_sites.h"
#include "vdb_madf/method/detail/power_values.h"

namespace vdb_madf::detail {

/// Does what sweepPower() does, for D up to kLargestKeyedSquaredRadius: each voxel looks at all
/// sites in reach.
void sweepWindows(const SweptLeaves& leaves, const ForeignSites* foreign, int32_t maxSquaredRadius,
                  const VoxelWeights& weights, PowerValues& values, Interrupter* interrupter);

}  // namespace vdb_madf::detail
