// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <string>
#include <vector>

#include "vdb_madf/grids/domain.h"

// How a file holds a domain that is a region: the grids whose domain it is name a Bool grid beside
// them, whose active voxels of value true it is (grids/detail/region_metadata.h).

namespace vdb_madf::detail {

/// The grids as a file holds them: those with a region, and the Bool grid with its voxels, last
/// unless it was given.
/// @throw InvalidInput that begins with `path` if they have different regions, or another grid has
///   the name of theirs.
std::vector<openvdb::GridBase::ConstPtr> withRegionGrid(
    const std::string& path, const std::vector<openvdb::GridBase::ConstPtr>& grids);

/// Gives a grid the domain that its file holds in another one.
/// @throw std::runtime_error if its box differs from what the grid says of it.
void takeRegion(openvdb::GridBase& grid, const Domain& domain);

}  // namespace vdb_madf::detail
