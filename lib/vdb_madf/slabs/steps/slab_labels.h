// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <functional>

#include "vdb_madf/slabs/steps/slab_work.h"

namespace vdb_madf::detail {

/// Keeps of the flow of a slab (Flow::manifold) what tidying will see beyond its cuts.
void writeRims(SlabWork& work, size_t slab, const SlabBody& body, VoxelArray<uint32_t> manifold);

/// Gets the labels of a slab, by rank in its body; 0: a cavity.
using PutLabels =
    std::function<void(size_t slab, const SlabBody& body, VoxelArray<uint32_t> labels)>;

/// The labels of all slabs, from where their voxels flow to and the grains of those terminals:
/// tidied, counted in result.grainVoxels (at the root), and put. The pieces kGrains are there, and
/// in result the voxels of the object and the number of grains. \p representatives: at the root.
void labelSlabs(SlabWork& work, std::vector<Coord> representatives, SlabSegmentation& result,
                const PutLabels& put);

/// A grid on the object in a slab.
Int32Grid::Ptr slabGrid(const SlabWork& work, size_t slab, const SlabBody& body,
                        VoxelArray<uint32_t> values, const char* name);

}  // namespace vdb_madf::detail
