// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <map>

#include "vdb_madf/labels/detail/label_leaves.h"
#include "vdb_madf/measure/detail/bond_depths.h"
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

using GrainRepresentatives = std::map<int32_t, GrainRepresentative>;  ///< by label

/// Empty if there is no background. Computed from the labels alone.
/// Memory while it runs: four bytes per voxel.
/// @param bonds gets the depths of the bonds, unless it is null
GrainRepresentatives grainRepresentatives(const LabelLeaves& labels, const Obstacles& obstacles,
                                          const VoxelWeights& weights, BondDepths* bonds,
                                          Interrupter* interrupter);

/// Takes over the candidates that lie deeper; they are of other voxels of the same labels.
void improve(const GrainRepresentatives& candidates, GrainRepresentatives& best);

/// Finds the representatives of labels that come in slabs. Distances that may end beyond what is
/// known of the labels around a slab are not taken: more is asked for.
class SlabRepresentatives {
 public:
  static constexpr int kFirstReach = 40;  ///< above and below a slab, a multiple of 8
  /// \p object bounds all labels, which are not all of an open domain. \p bonds as above.
  SlabRepresentatives(const CoordBBox& object, const Obstacles& obstacles,
                      const VoxelWeights& weights, BondDepths* bonds);

  /// The layers that have to be known to add some. More than at first may turn out to be needed.
  LeafLayers around(const LeafLayers& own) const;
  /// Adds those of the layers `own`. \p labels: of around(own)
  /// @return false if nothing was added, because more has to be known. @throw Interrupted
  bool add(const LabelLeaves& labels, const LeafLayers& own, Interrupter* interrupter);

  GrainRepresentatives best;

 private:
  CoordBBox domain_;  // background is what it holds besides
  VoxelWeights weights_;
  BondDepths* bonds_;
  int reach_ = kFirstReach;
};

/// Takes the representatives of labels that were segmented without a filter from the critical
/// points. The deepest voxel p of a grain is one of them: were p in the cell of a ball s != p, then
/// by |p - s|^2 - D(s) <= -D(p) that s, of the same grain, would lie deeper.
GrainRepresentatives grainRepresentatives(const Int32Grid& labels, const ManifoldGraph& graph);

}  // namespace vdb_madf::detail
