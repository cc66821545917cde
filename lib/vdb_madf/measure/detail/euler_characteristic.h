// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstdint>

#include "vdb_madf/leaves/detail/leaf_layers.h"
#include "vdb_madf/leaves/leaf_index.h"

namespace vdb_madf::detail {

/// Euler characteristic of X for 6-connected object and 26-connected background: voxels - pairs of
/// face neighbors + full 2x2x1 squares - full 2x2x2 cubes. It is components - tunnels + cavities: 1
/// for a ball, 0 for a ring, 2 for a hollow ball. X ends at the border of the domain, a box or a
/// region, whatever lies beyond. From masks alone, exact. Of some layers: what their leaves
/// contribute to the sum, where the next ones have to be there, too. @throw Interrupted
int64_t eulerCharacteristic(const LeafIndex& index, const LeafLayers& layers = {},
                            Interrupter* interrupter = nullptr);

}  // namespace vdb_madf::detail
