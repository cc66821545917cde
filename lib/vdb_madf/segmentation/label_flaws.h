// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "vdb_madf/grids/domain.h"
#include "vdb_madf/leaves/leaf_index.h"
#include "vdb_madf/leaves/voxel_array.h"

namespace vdb_madf {

/// Grains that are hardly true ones. A grain touches another if they have adjacent voxels.
struct LabelFlaws {
  int64_t crumbs = 0;   ///< under 100 voxels, touching another grain
  int64_t specks = 0;   ///< under 100 voxels, touching none: loose pieces
  int64_t slivers = 0;  ///< 20 voxels or more, touching another grain, and nowhere two layers deep:
                        ///< around each voxel one of the 26 in the domain is not of the grain
  int64_t inPieces = 0;  ///< not 6-connected
};

/// \p labels: 1 .. grains by voxel, 0: not of the object. \p grainVoxels: of grain g at g - 1.
/// @throw Interrupted
LabelFlaws labelFlaws(const LeafIndex& index, const VoxelArray<uint32_t>& labels,
                      const std::vector<int64_t>& grainVoxels, const std::optional<Domain>& domain,
                      Interrupter* interrupter = nullptr);

}  // namespace vdb_madf
