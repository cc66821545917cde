// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <optional>
#include <vector>

#include "vdb_madf/method/boundary.h"
#include "vdb_madf/method/detail/slab_faces.h"
#include "vdb_madf/slabs/detail/site_offers.h"

namespace vdb_madf::detail {

/// The balls of a slab that may win beyond its cuts, of the distances near the cuts alone.
///
/// A distance only depends on the rows along z of its own layer, so a part of a slab is measured as the
/// whole is, if it is told the columns beyond. How many voxels h of the layers at a cut are enough? The
/// ball of a voxel further away that reaches beyond the cut holds the voxel of its column in the last
/// of these layers; so that voxel is object, and as roots of squared distances differ by no more than
/// the way between two voxels, its own ball reaches beyond the cut, too. If no ball of that layer does,
/// none further away does.
class NearCuts {
 public:
  NearCuts(const LeafIndex& slab, const Obstacles& obstacles, const VoxelWeights& weights,
           const SlabFaces& faces, Interrupter* interrupter)
      : slab_(slab),
        obstacles_(obstacles),
        weights_(weights),
        faces_(faces),
        interrupter_(interrupter) {}

  /// Those of siteOffers(). @throw as squaredDistanceInSlab()
  std::vector<ForeignSite> offers(bool isUpper);

 private:
  SlabFaces nearFaces(const Cut& cut, int reach) const;
  SquaredDistance measure(const LeafIndex& index, const SlabFaces& faces) const;

  const LeafIndex& slab_;
  const Obstacles& obstacles_;
  VoxelWeights weights_;
  const SlabFaces& faces_;
  Interrupter* interrupter_;
  std::optional<SquaredDistance> whole_;
};

}  // namespace vdb_madf::detail
