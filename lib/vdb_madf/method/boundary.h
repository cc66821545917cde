// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <optional>
#include <string>

#include "vdb_madf/grids/domain.h"
#include "vdb_madf/leaves/leaf_index.h"

namespace vdb_madf {

/// What lies beyond the faces of a scan, or outside its region.
enum class Boundary {
  /// Open if the domain is known, else closed.
  automatic,
  /// Only voxels inside the domain are background, the others are unknown: a grain that a face of
  /// the scan cuts is not rounded off there.
  open,
  /// Everything outside the object is background.
  closed
};

/// Boundary and domain, resolved: an open one has a domain.
struct Obstacles {
  bool open = false;
  Domain domain;  ///< used if open

  /// May there be unknown voxels within the domain's box?
  bool inRegion() const { return open && !domain.isBox(); }
};

/// @throw InvalidInput: a box of an object, which may be empty, reaches beyond that of the domain.
void checkWithin(const CoordBBox& object, const Domain& domain);

/// @throw InvalidInput: open without a domain, or voxels of `index` outside the domain.
Obstacles resolveBoundary(const LeafIndex& index, Boundary boundary,
                          const std::optional<Domain>& domain);

/// Warns, as a sentence for the user, where a closed boundary leaves nothing of an object: in a
/// domain of one voxel along an axis all of it is at a face. Empty elsewhere.
std::string noteOnBoundary(Boundary boundary, const std::optional<Domain>& domain);

/// The boundary that a grid says it wants or was segmented with (`madf_boundary`: "open",
/// "closed"); automatic if it says nothing.
Boundary storedBoundary(const openvdb::GridBase& grid);
void setBoundary(openvdb::GridBase& grid, Boundary boundary);  ///< automatic: says nothing

}  // namespace vdb_madf
