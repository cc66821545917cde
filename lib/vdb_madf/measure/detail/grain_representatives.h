// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <map>

#include "vdb_madf/labels/detail/label_leaves.h"
#include "vdb_madf/method/boundary.h"
#include "vdb_madf/method/squared_distance.h"

namespace vdb_madf::detail {

/// The voxel of a grain that lies deepest in the object: of largest squared distance to the
/// background, of several the first (x, then y, then z).
struct GrainRepresentative {
  Coord voxel;
  int32_t squaredRadius = 0;  ///< voxels squared
};

/// By label; empty if there is no background. Computed from the labels alone; without a gamma
/// filter these are the critical points that the segmentation numbers grains by.
/// Memory while it runs: four bytes per voxel.
std::map<int32_t, GrainRepresentative> grainRepresentatives(const LabelLeaves& labels,
                                                            const Obstacles& obstacles,
                                                            Interrupter* interrupter);

}  // namespace vdb_madf::detail
