// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <map>
#include <utility>

#include "vdb_madf/labels/detail/label_leaves.h"
#include "vdb_madf/leaves/voxel_array.h"

namespace vdb_madf::detail {

/// By labels, the smaller one first: the largest that is found at a voxel face between the two, of
/// the smaller of the squared distances of its two voxels.
using BondDepths = std::map<std::pair<int32_t, int32_t>, int32_t>;

/// Adds the faces whose lower voxel lies in some layers of leaves.
/// \p distances: squared, to the background. @throw Interrupted
void addBondDepths(const LabelLeaves& labels, const LeafLayers& layers,
                   const VoxelArray<int32_t>& distances, BondDepths& depths,
                   Interrupter* interrupter);

}  // namespace vdb_madf::detail
