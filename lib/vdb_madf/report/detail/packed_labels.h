// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "vdb_madf/base/interrupter.h"
#include "vdb_madf/grids/grid_types.h"

namespace vdb_madf::detail {

/// The labels of a box for the page, x fastest, then y, then z: pairs of PackedBytes::variable()
/// numbers, how many voxels in a row (past the end of a line, too) and what they hold: 0, or the
/// place of their label in \p ids, counted from 1. Labels that are not there count as 0.
/// @param ids ascending
/// @throw Interrupted
std::string packLabels(const Int32Grid& labels, const CoordBBox& box,
                       const std::vector<int32_t>& ids, Interrupter* interrupter);

}  // namespace vdb_madf::detail
