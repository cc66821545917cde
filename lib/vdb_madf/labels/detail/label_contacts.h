// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstdint>
#include <vector>

#include "vdb_madf/grids/grid_types.h"

namespace vdb_madf::detail {

/// Two labels, first < second, and the voxel faces between them.
struct LabelContact {
  int32_t first = 0, second = 0;
  int64_t faces = 0;
};

/// All pairs that share a face, ascending. @throw InvalidInput as LeafIndex does; Interrupted
std::vector<LabelContact> labelContacts(const Int32Grid& labels, Interrupter* interrupter);

}  // namespace vdb_madf::detail
