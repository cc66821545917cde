// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/method/boundary.h"

#include <openvdb/Metadata.h>

#include <sstream>

#include "vdb_madf/base/errors.h"
#include "vdb_madf/grids/grid_metadata.h"
#include "vdb_madf/leaves/detail/leaf_mask.h"

namespace vdb_madf {

namespace {

std::string toString(const CoordBBox& box) {
  std::ostringstream text;
  text << box;
  return text.str();
}

bool leavesRegion(const LeafIndex& index, const Domain& domain) {
  for (size_t leaf = 0; leaf < index.leafCount(); ++leaf) {
    const LeafIndex::Mask inside = detail::insideMask(domain, index.origin(leaf));
    if (detail::anyVoxel(detail::without(index.mask(leaf), inside))) return true;
  }
  return false;
}

}  // namespace

void checkWithin(const CoordBBox& object, const Domain& domain) {
  if (object.empty() || domain.box().isInside(object)) return;
  throw InvalidInput("the object leaves the domain: object " + toString(object) + ", domain " +
                     toString(domain.box()) + "; crop the object, or give a domain that holds it");
}

Obstacles resolveBoundary(const LeafIndex& index, Boundary boundary,
                          const std::optional<Domain>& domain) {
  if (boundary == Boundary::open && !domain)
    throw InvalidInput(
        "the open boundary needs a known domain: give one, or use the closed boundary");
  if (domain && index.voxelCount() > 0) checkWithin(index.boundingBox(), *domain);
  if (domain && !domain->isBox() && leavesRegion(index, *domain))
    throw InvalidInput("the object leaves the region: crop the object, or give one that holds it");
  Obstacles obstacles;
  obstacles.open = domain && boundary != Boundary::closed;
  if (obstacles.open) obstacles.domain = *domain;
  return obstacles;
}

std::string noteOnBoundary(Boundary boundary, const std::optional<Domain>& domain) {
  const auto axis = domain ? domain->flatAxis() : std::nullopt;
  if (boundary != Boundary::closed || !axis) return "";
  return std::string("one voxel along ") + "xyz"[*axis] +
         ", and a closed boundary has background on both sides of it, so each voxel is a ball of "
         "its own: leave it open";
}

Boundary storedBoundary(const openvdb::GridBase& grid) {
  const auto text = grid.getMetadata<openvdb::StringMetadata>(kBoundaryKey);
  if (!text) return Boundary::automatic;
  return text->value() == "open" ? Boundary::open : Boundary::closed;
}

void setBoundary(openvdb::GridBase& grid, Boundary boundary) {
  grid.removeMeta(kBoundaryKey);
  if (boundary != Boundary::automatic)
    grid.insertMeta(kBoundaryKey,
                    openvdb::StringMetadata(boundary == Boundary::open ? "open" : "closed"));
}

}  // namespace vdb_madf
