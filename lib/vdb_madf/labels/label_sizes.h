// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstdint>
#include <map>

#include "vdb_madf/grids/grid_types.h"
#include "vdb_madf/grids/label_slabs.h"

namespace vdb_madf {

/// Voxels of each label above 0, tiles included. @throw Interrupted
std::map<int32_t, int64_t> labelSizes(const Int32Grid& labels, Interrupter* interrupter = nullptr);

/// Labels in slabs, of which one is in memory at a time. @throw what reading throws
std::map<int32_t, int64_t> labelSizes(const LabelSlabs& labels, Interrupter* interrupter = nullptr);

}  // namespace vdb_madf
