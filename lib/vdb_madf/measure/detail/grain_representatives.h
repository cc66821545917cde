// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <map>

#include "vdb_madf/labels/detail/label_leaves.h"
#include "vdb_madf/method/boundary.h"
#include "vdb_madf/method/manifold_graph.h"
#include "vdb_madf/method/squared_distance.h"

namespace vdb_madf::detail {

/// The voxel of a grain that lies deepest in the object: of largest squared distance to the
/// background, of several the first (x, then y, then z).
struct GrainRepresentative {
  Coord voxel;
  int32_t squaredRadius = 0;  ///< in the unit of the weights
};

/// By label.
using GrainRepresentatives = std::map<int32_t, GrainRepresentative>;

/// Empty if there is no background. Computed from the labels alone.
/// Memory while it runs: four bytes per voxel.
GrainRepresentatives grainRepresentatives(const LabelLeaves& labels, const Obstacles& obstacles,
                                          const VoxelWeights& weights, Interrupter* interrupter);

/// The same of labels that were segmented without a filter, from the critical points. The deepest
/// voxel p of a grain is one of them: were p in the cell of a ball s != p, then by
/// |p - s|^2 - D(s) <= -D(p) that s, of the same grain, would lie deeper.
GrainRepresentatives grainRepresentatives(const Int32Grid& labels, const ManifoldGraph& graph);

}  // namespace vdb_madf::detail
