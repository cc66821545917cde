// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace vdb_madf::detail {

/// Squared distances of the voxels of a dense block to the nearest source; those beyond `reach` are
/// (reach + 1)^2. One axis after the other (Saito & Toriwaki 1994), only as far as it reaches.
/// @param sizes of the axes, the one whose voxels follow one another last
/// @param isSource one for each voxel, 0 or 1
/// @param reach at most 100
std::vector<int16_t> nearSquares(const std::array<size_t, 3>& sizes,
                                 const std::vector<uint8_t>& isSource, int reach);

}  // namespace vdb_madf::detail
