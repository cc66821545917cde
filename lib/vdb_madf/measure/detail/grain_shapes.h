// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <vector>

#include "vdb_madf/labels/detail/label_leaves.h"
#include "vdb_madf/measure/detail/voxel_shape.h"
#include "vdb_madf/measure/measure_grains.h"

namespace vdb_madf::detail {

/// Sets the shapes of the grains, which are all that the labels have, by id. Memory: 16 bytes for
/// each label of a leaf, and for each thread the ends of the rows of voxels of a grain.
void measureShapes(const LabelLeaves& labels, const VoxelShape& voxel,
                   std::vector<GrainMeasures>& grains, Interrupter* interrupter);

}  // namespace vdb_madf::detail
