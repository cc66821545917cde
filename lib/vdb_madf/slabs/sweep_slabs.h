// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <vector>

#include "vdb_madf/grids/label_slabs.h"
#include "vdb_madf/segmentation/parameter_sweep.h"
#include "vdb_madf/slabs/scratch.h"

namespace vdb_madf {

/// mergingSweep() for manifolds that need not fit in memory together: the same rows. Each row goes
/// through all slabs; memory and `scratch` as remergeSlabs().
/// @throw as remergeSlabs() and mergingSweep()
std::vector<SweepRow> mergingSweep(const LabelSlabs& manifolds, const SweepOptions& options,
                                   Scratch& scratch, Interrupter* interrupter = nullptr);

}  // namespace vdb_madf
