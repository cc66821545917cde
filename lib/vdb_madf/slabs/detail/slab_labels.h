// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include "vdb_madf/method/merge.h"
#include "vdb_madf/slabs/detail/slab_work.h"

namespace vdb_madf::detail {

/// Message from the root: the grain of each terminal of a slab.
constexpr char kGrainsOfTerminals[] = "grains";

/// Keeps of the flow of a slab (Flow::manifold) what tidying will see beyond its cuts.
void writeRims(SlabWork& work, size_t slab, const SlabBody& body, VoxelArray<uint32_t> manifold);

/// The labels of all slabs, from where their voxels flow to and the grains of those terminals: tidied,
/// counted in result.grainVoxels (at the root), and put. \p merging: of result.graph, at the root.
void labelSlabs(SlabWork& work, const Merging& merging, SlabSegmentation& result,
                const PutSlabLabels& put);

}  // namespace vdb_madf::detail
