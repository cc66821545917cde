// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <vector>

#include "vdb_madf/method/detail/foreign_sites.h"
#include "vdb_madf/method/detail/slab_faces.h"

namespace vdb_madf::detail {

/// A cut of the slab begin <= z < end, seen from that slab: the upper one or the lower one.
struct Cut {
  int begin, end;
  bool isUpper;

  int layer() const { return isUpper ? end - 1 : begin; }  ///< z of the slab's voxels beside it
  /// Voxels along z from a voxel to the first one beyond the cut.
  int away(int z) const { return isUpper ? end - z : z - begin + 1; }
};

/// The balls of a slab that may win beyond a cut: of each column those that have the least power,
/// below 0, somewhere in line beyond it, joined to the cut by object voxels. In ColumnOrder.
/// \p squaredRadius: of voxels, 0 for one that is no site.
///
/// At a voxel the order of sites is total (power, then D, then position), so a site that loses in
/// line to others of its column loses for good: the passes along x and y see the best of a column.
std::vector<ForeignSite> siteOffers(const LeafIndex& index,
                                    const VoxelArray<int32_t>& squaredRadius, int32_t weight,
                                    const Cut& cut);

/// Offers besides the balls (in ColumnOrder, too) that were offered to the slab at its other cut:
/// they go on where a column is object from cut to cut. \p columns: those beside the cut.
std::vector<ForeignSite> passOn(const std::vector<ForeignSite>& own,
                                const std::vector<ForeignSite>& offered, const ColumnSteps& columns,
                                int32_t weight, const Cut& cut);

}  // namespace vdb_madf::detail
