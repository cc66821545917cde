// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "vdb_madf/grids/grid_types.h"
#include "vdb_madf/leaves/leaf_index.h"

namespace vdb_madf::detail {

/// A copy of labels, metadata too, in which each label that is the first of a pair has become the
/// second; what has another one is background, inactive. Tiles stay tiles.
/// @param to ascending, each label once
Int32Grid::Ptr relabelled(const Int32Grid& labels,
                          const std::vector<std::pair<int32_t, int32_t>>& to,
                          Interrupter* interrupter);

/// Gives active voxels a label.
void setVoxels(Int32Grid& labels, const std::vector<LeafIndex::LeafVoxels>& voxels, int32_t label);

}  // namespace vdb_madf::detail
