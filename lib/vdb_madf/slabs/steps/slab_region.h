// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <optional>
#include <vector>

#include "vdb_madf/method/detail/foreign_sites.h"
#include "vdb_madf/method/power_map.h"
#include "vdb_madf/slabs/steps/slab_work.h"

// Slabs in a region. There the nearest background, and the way to it, may lie beyond unknown
// voxels, so that rows along z do not tell what crosses a cut. Instead a slab sees all that may
// matter around it: the object as far from its cuts as twice the radius of the largest ball, and is
// mapped with that.

namespace vdb_madf::detail {

/// Tells the other members of the own slabs that lie as near to theirs as `reach` voxels; all call
/// it. (Where the scratch is shared, there is nothing to tell.)
void shareBodies(SlabWork& work, int reach);

/// What others told is not needed any more.
void forgetBodies(SlabWork& work);

/// The largest squared distance in a slab, if it can be told from what lies within `reach` of it:
/// what is measured in a window is right if the window goes on as far.
std::optional<int32_t> largestInRegion(const SlabWork& work, size_t slab, int reach,
                                       Interrupter* interrupter);

/// How far around a slab the functions below look.
int mappedReach(const SlabWork& work);

/// The power map of all balls in a slab. Names the leaves of foreign balls in
/// its index.
PowerMap powerMapInRegion(const SlabWork& work, size_t slab, LeafIndex& index,
                          Interrupter* interrupter);

/// The power map of some balls: all that lie as far from the slab as the radius of the largest
/// ball.
PowerMap filteredInRegion(const SlabWork& work, size_t slab, const std::vector<ForeignSite>& sites,
                          LeafIndex& index, Interrupter* interrupter);

/// Does something in slab `other` reach a slab?
bool isInReach(const SlabWork& work, size_t slab, size_t other);

}  // namespace vdb_madf::detail
