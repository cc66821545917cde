// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include "vdb_madf/slabs/detail/slab_grains.h"
#include "vdb_madf/slabs/detail/slab_work.h"

namespace vdb_madf::detail {

/// The labels of all slabs, from where their voxels flow to and the grains of that: tidied,
/// counted in result.grainVoxels, and put.
void labelSlabs(SlabWork& work, const SlabGrains& grains, SlabSegmentation& result,
                const PutSlabLabels& put);

}  // namespace vdb_madf::detail
