// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstdint>

#include "vdb_madf/leaves/detail/leaf_layers.h"
#include "vdb_madf/leaves/leaf_index.h"

namespace vdb_madf::detail {

/// What the leaves in some layers contribute to the Euler characteristic, which is the sum of all
/// such parts. The next leaves have to be there, too. @throw Interrupted
int64_t eulerCharacteristic(const LeafIndex& index, const LeafLayers& layers,
                            Interrupter* interrupter);

}  // namespace vdb_madf::detail
