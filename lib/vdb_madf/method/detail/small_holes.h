// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <optional>

#include "vdb_madf/method/cavities.h"

namespace vdb_madf::detail {

/// findCavities() of an object with a voxel at least and fillHoles > 1, but for its rule that not
/// all background may be filled: for a part of a volume.
Cavities smallHoles(const LeafIndex& object, const std::optional<Domain>& domain, bool open,
                    int64_t fillHoles, Interrupter* interrupter);

}  // namespace vdb_madf::detail
