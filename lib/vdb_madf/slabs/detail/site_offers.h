// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <vector>

#include "vdb_madf/method/detail/foreign_sites.h"
#include "vdb_madf/method/squared_distance.h"

namespace vdb_madf::detail {

/// The balls that may win beyond a cut, the upper one of the slab begin <= z < end (`above`: to the
/// slab above) or the lower one: of each column those that have the least power, below 0, somewhere
/// in line beyond it, joined to the cut by object voxels. Among them are balls that were offered to
/// this slab at its other cut, where a column is object from cut to cut.
///
/// At a voxel the order of sites is total (power, then D, then position), so a site that loses in
/// line to others of its column loses for good: the passes along x and y see the best of a column.
std::vector<ForeignSite> siteOffers(const LeafIndex& index, const SquaredDistance& distance,
                                    const std::vector<ForeignSite>& offered, int begin, int end,
                                    bool above);

}  // namespace vdb_madf::detail
