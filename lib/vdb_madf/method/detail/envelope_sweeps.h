// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include "vdb_madf/method/detail/foreign_sites.h"
#include "vdb_madf/method/detail/power_values.h"

namespace vdb_madf::detail {

/// Does what sweepPower() does, for balls of any size: each row takes the lower envelope of its
/// parabolas. If maxSquaredRadius and the object are so large that 64-bit keys overflow, the slower
/// 128-bit ones are used.
void sweepEnvelopes(const SweptLeaves& leaves, const ForeignSites* foreign,
                    int32_t maxSquaredRadius, const VoxelWeights& weights, PowerValues& values,
                    Interrupter* interrupter);

}  // namespace vdb_madf::detail
