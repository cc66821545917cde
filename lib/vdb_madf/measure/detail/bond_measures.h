// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <vector>

#include "vdb_madf/measure/detail/label_sums.h"
#include "vdb_madf/measure/measure_bonds.h"

namespace vdb_madf::detail {

/// The measures of bonds but for distance and angle. @throw Interrupted
std::vector<BondMeasures> bondMeasures(const std::vector<BondSums>& sums, const VoxelShape& voxel,
                                       Interrupter* interrupter);

}  // namespace vdb_madf::detail
