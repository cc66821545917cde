// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstdint>

#include "vdb_madf/method/boundary.h"

namespace vdb_madf::detail {

/// @throw InvalidInput if the object fills an open domain
void checkBackground(const Obstacles& obstacles, int64_t objectVoxels);

}  // namespace vdb_madf::detail
