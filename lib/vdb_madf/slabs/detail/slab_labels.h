// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include "vdb_madf/slabs/detail/slab_grains.h"

namespace vdb_madf::detail {

/// Keeps of the flow of a slab (Flow::manifold) what tidying will see beyond its cuts.
void writeRims(SlabWork& work, size_t slab, const SlabBody& body, VoxelArray<uint32_t> manifold);

/// The labels of all slabs, from where their voxels flow to and the grains of those terminals: tidied,
/// counted in result.grainVoxels (at the root), and put. \p representatives: at the root.
void labelSlabs(SlabWork& work, std::vector<Coord> representatives, SlabSegmentation& result,
                const PutSlabLabels& put);

}  // namespace vdb_madf::detail
