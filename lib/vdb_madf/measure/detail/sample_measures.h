// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <vector>

#include "vdb_madf/grids/domain.h"
#include "vdb_madf/measure/measure_bonds.h"
#include "vdb_madf/measure/measure_grains.h"
#include "vdb_madf/measure/measure_sample.h"

namespace vdb_madf::detail {

/// What follows from the tables of grains and bonds, and the domain that fractions refer to, alone.
SampleMeasures sampleMeasures(const std::vector<GrainMeasures>& grains,
                              const std::vector<BondMeasures>& bonds, const Domain& domain);

}  // namespace vdb_madf::detail
