// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/vdb/detail/region_grid.h"

#include <memory>
#include <stdexcept>

#include "vdb_madf/base/errors.h"
#include "vdb_madf/grids/detail/region_metadata.h"
#include "vdb_madf/grids/grid_metadata.h"
#include "vdb_madf/grids/object_mask.h"

namespace vdb_madf::detail {

namespace {

using openvdb::GridBase;

bool sameVoxels(const MaskTree& a, const MaskTree& b) {
  return &a == &b || Domain(a) == Domain(b);
}

/// Its voxels, at the place of a grid whose domain it is.
GridBase::ConstPtr regionGrid(const MaskTree& region, const GridBase& of) {
  const auto mask = MaskGrid::create(std::make_shared<MaskTree>(region));
  mask->setName(kRegionGrid);
  mask->setTransform(of.transform().copy());
  setDomain(*mask, Domain(region).box());
  return toBoolGrid(*mask);
}

}  // namespace

std::vector<GridBase::ConstPtr> withRegionGrid(const std::string& path,
                                               const std::vector<GridBase::ConstPtr>& grids) {
  GridBase::ConstPtr owner, given;
  for (const GridBase::ConstPtr& grid : grids) {
    const auto region = regionOf(*grid);
    if (!region) continue;
    if (!owner) owner = grid;
    if (!sameVoxels(*region, *regionOf(*owner)))
      throw InvalidInput(path + ": the domains of grids '" + owner->getName() + "' and '" +
                         grid->getName() +
                         "' are different regions, and a file holds one: write them to two files");
  }
  if (!owner) return grids;
  for (const GridBase::ConstPtr& grid : grids) {
    if (grid->getName() != kRegionGrid) continue;
    if (given || !grid->isType<BoolGrid>() ||
        !sameVoxels(objectMask(*grid)->tree(), *regionOf(*owner)))
      throw InvalidInput(path + ": a grid is called '" + kRegionGrid +
                         "', the name of the grid that holds the domain of '" + owner->getName() +
                         "': give it another name");
    given = grid;
  }
  std::vector<GridBase::ConstPtr> all = grids;
  if (!given) all.push_back(regionGrid(*regionOf(*owner), *owner));
  return all;
}

void takeRegion(GridBase& grid, const Domain& domain) {
  grid.removeMeta(kRegionKey);
  const auto box = storedDomain(grid);
  if (box && box->box() != domain.box())
    throw std::runtime_error("the region of a grid and its domain differ");
  setDomain(grid, domain);
}

}  // namespace vdb_madf::detail
