// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <vector>

#include "vdb_madf/measure/detail/label_sums.h"
#include "vdb_madf/measure/measure_bonds.h"
#include "vdb_madf/measure/measure_grains.h"

namespace vdb_madf::detail {

/// From the sums and the bonds; the representatives are left to be filled in.
std::vector<GrainMeasures> grainMeasures(const LabelSums& sums,
                                         const std::vector<BondMeasures>& bonds,
                                         const Domain& domain, const VoxelShape& voxel);

}  // namespace vdb_madf::detail
