// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include "vdb_madf/method/power_map.h"
#include "vdb_madf/slabs/steps/slab_reach.h"
#include "vdb_madf/slabs/steps/slab_work.h"

namespace vdb_madf::detail {

/// The largest squared distance in a slab.
struct Largest {
  int32_t squaredDistance;
  /// The reach of the window that told it (slab_region.h); 0: none has yet, or none is needed.
  int32_t reach;
};

/// The power map of all balls in a slab. Names the leaves of foreign balls in its index. Leaves the
/// piece kLargest, but in a region. @throw as squaredDistanceInSlab()
PowerMap slabPowerMap(SlabWork& work, const SlabOffers& offers, size_t slab, LeafIndex& index,
                      Interrupter* interrupter);

/// A map in scratch: sites, powers, and the names of foreign leaves.
void writeMap(SlabWork& work, size_t slab, const LeafIndex& index, const PowerMap& map);
PowerMap readMap(const SlabWork& work, size_t slab, LeafIndex& index);

}  // namespace vdb_madf::detail
