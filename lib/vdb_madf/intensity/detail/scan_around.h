// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <vector>

#include "vdb_madf/grids/grid_types.h"
#include "vdb_madf/intensity/gray_scan.h"

namespace vdb_madf::detail {

/// The scan's values in the leaf nodes that the boxes touch, read in layers of these.
/// @throw IoError; Interrupted
FloatGrid::TreeType::Ptr readAround(const std::vector<CoordBBox>& boxes, GrayScan& scan,
                                    Interrupter* interrupter);

/// What a scan shows outside of a region belongs to nothing known: NaN.
void forgetOutside(const MaskTree& region, FloatGrid::TreeType& gray);

}  // namespace vdb_madf::detail
