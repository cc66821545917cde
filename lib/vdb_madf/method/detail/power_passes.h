// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include "vdb_madf/method/power_map.h"

namespace vdb_madf::detail {

/// The power map of some balls only, with map.weights. `map.power` holds -D(x) at their sites x and
/// kUncovered at the other object voxels; voxels that no ball covers stay kUncovered.
///
/// Separable (Coeurjolly & Montanvert 2007), along z, y, x. Where no D is larger than
/// kLargestKeyedSquaredRadius each voxel looks at all sites of its row in reach (window_sweeps.h),
/// else rows take lower envelopes (envelope_sweeps.h). Either stays within the runs of X, exactly:
/// if pi_x(p) < 0 the path x -> z -> y -> p lies in the open ball (x, D(x)), which holds no
/// background: squares add up along the axes, with weights too. (With map.passage they also pass
/// the unknown voxels that such a path may touch.) No ball may be larger than `maxSquaredRadius`.
/// @throw Interrupted
void sweepPower(const LeafIndex& index, int32_t maxSquaredRadius, PowerMap& map,
                Interrupter* interrupter = nullptr);

}  // namespace vdb_madf::detail
