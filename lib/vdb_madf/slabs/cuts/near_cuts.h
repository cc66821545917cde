// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <optional>
#include <vector>

#include "vdb_madf/method/boundary.h"
#include "vdb_madf/method/detail/slab_faces.h"
#include "vdb_madf/slabs/cuts/site_offers.h"

namespace vdb_madf::detail {

/// The balls of a slab that may win beyond its cuts, of the distances near the cuts alone.
///
/// After the pass along z a distance only depends on voxels of its own layer, so some layers of a
/// slab are measured as the whole is, if they are told how the columns go on. How many layers at a
/// cut are enough? Take a voxel further away that is joined to the cut by object voxels of its
/// column, and whose ball reaches beyond the cut. One of these is in the last of the layers; as
/// roots of squared distances differ by no more than the way between two voxels, its ball reaches
/// beyond the cut, too. So if no ball of that layer does, no voxel further away is offered.
class NearCuts {
 public:
  NearCuts(const LeafIndex& slab, const Obstacles& obstacles, const VoxelWeights& weights,
           const SlabFaces& faces, Interrupter* interrupter)
      : slab_(slab),
        obstacles_(obstacles),
        weights_(weights),
        faces_(faces),
        interrupter_(interrupter) {}

  /// The offers that siteOffers() makes. @throw as squaredDistanceInSlab()
  std::vector<ForeignSite> offers(bool isUpper);

 private:
  SlabFaces nearFaces(const Cut& cut, int reach) const;
  /// Measures in the part of the work that a cut is.
  SquaredDistance measure(const LeafIndex& index, const SlabFaces& faces, bool isUpper) const;

  const LeafIndex& slab_;
  const Obstacles& obstacles_;
  VoxelWeights weights_;
  const SlabFaces& faces_;
  Interrupter* interrupter_;
  std::optional<SquaredDistance> whole_;
};

}  // namespace vdb_madf::detail
