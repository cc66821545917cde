// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <vector>

#include "vdb_madf/grids/grid_types.h"

namespace vdb_madf {

/// A copy of a label grid that holds some grains alone, under their own labels: all else is
/// background. What takes labels then sees these grains, at their cost. Name, transform, domain and
/// voxel size are the labels'; the order of `grains` and repetitions do not matter.
/// @throw InvalidInput if a label has no active voxel; Interrupted.
Int32Grid::Ptr selectGrains(const Int32Grid& labels, const std::vector<int32_t>& grains,
                            Interrupter* interrupter = nullptr);

}  // namespace vdb_madf
