// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstdint>

#include "vdb_madf/leaves/leaf_index.h"

namespace vdb_madf::detail {

/// The `values`, of a VoxelArray, of the 64 voxels of a leaf at one position (0 to 7) along an
/// axis, by their other two coordinates, the slower one first; 0 where there is no object voxel, or
/// no leaf (LeafIndex::kNone). May read (and does not use) the value past the leaf's last.
void copyFace(const LeafIndex& index, const uint32_t* values, uint32_t leaf, int axis, int position,
              uint32_t* face);

/// Bit i: is there an object voxel at face[i] of the above?
uint64_t faceMask(const LeafIndex& index, uint32_t leaf, int axis, int position);
/// Bit i: is there a voxel of `mask`, some voxels of a leaf, at place i of its face?
uint64_t faceMask(const LeafIndex::Mask& mask, int axis, int position);

}  // namespace vdb_madf::detail
