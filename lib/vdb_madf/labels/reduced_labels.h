// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include "vdb_madf/grids/grid_types.h"
#include "vdb_madf/grids/label_slabs.h"

namespace vdb_madf {

// Label grids made smaller by a whole factor: coarse voxel (i,j,k) stands for the fine voxels
// factor * i .. factor * i + factor - 1 along each axis, and its center lies at their center in the
// world. Domain and voxel size follow (of a domain that is no box: the coarse voxels of which at
// least half of what its box has of them lies in it); provenance is carried over. Labels are the
// active voxels (tiles included) of positive value. Factor 1 changes nothing but the topology: no
// tiles.

constexpr int kMaxReduction = 256;

/// The smallest factor that makes a box at most `maxDim` voxels long.
/// @throw InvalidInput if that exceeds kMaxReduction, or maxDim < 1.
int reductionFor(const CoordBBox& box, int maxDim);

/// Each coarse voxel takes the most frequent value of its fine ones in the box of the domain,
/// background (0) included; of equally frequent ones the smallest. Labels are never averaged.
/// @throw InvalidInput if the factor is not 1 .. kMaxReduction; Interrupted.
Int32Grid::Ptr reduceLabels(const Int32Grid& labels, int factor,
                            Interrupter* interrupter = nullptr);

/// Labels in slabs, of which some layers are in memory at a time.
/// @throw as above; what reading throws
Int32Grid::Ptr reduceLabels(const LabelSlabs& labels, int factor,
                            Interrupter* interrupter = nullptr);

/// The transform of reduced labels in the length unit of those that they were made of, which is
/// another one where only the finer voxels are below 20 nm (see VoxelSize).
openvdb::math::Transform::Ptr transformInUnitOf(const Int32Grid& labels, const Int32Grid& reduced);

}  // namespace vdb_madf
