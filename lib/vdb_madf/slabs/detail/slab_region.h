// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <vector>

#include "vdb_madf/method/detail/foreign_sites.h"
#include "vdb_madf/method/power_map.h"
#include "vdb_madf/slabs/detail/slab_work.h"

// Slabs in a region. There the nearest background, and the way to it, may lie beyond unknown voxels, so
// that rows along z do not tell what crosses a cut. Instead a slab sees all that may matter around it:
// the object as far from its cuts as twice the radius of the largest ball, and is mapped with that.

namespace vdb_madf::detail {

/// The largest squared distance in a slab. It is exact: what is measured in a window is right if the
/// window goes on as far, and the window grows until it does.
int32_t largestInRegion(const SlabWork& work, size_t slab, Interrupter* interrupter);

/// The power map of all balls in a slab. Names the leaves of foreign balls in
/// its index.
PowerMap powerMapInRegion(const SlabWork& work, size_t slab, LeafIndex& index,
                          Interrupter* interrupter);

/// That of some balls: all that lie as far from the slab as the radius of the largest ball.
PowerMap filteredInRegion(const SlabWork& work, size_t slab, const std::vector<ForeignSite>& sites,
                          LeafIndex& index, Interrupter* interrupter);

/// Does something in slab `other` reach a slab?
bool isInReach(const SlabWork& work, size_t slab, size_t other);

}  // namespace vdb_madf::detail
