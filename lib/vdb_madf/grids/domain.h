// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <memory>
#include <optional>
#include <utility>

#include "vdb_madf/grids/grid_types.h"

namespace vdb_madf {

/// The image domain B, all that was scanned: a box, or a set of voxels (a region), such as the
/// round field of view of a core. Outside B nothing is known. Copies share the region.
class Domain {
 public:
  Domain() = default;                          ///< the empty box
  Domain(const CoordBBox& box) : box_(box) {}  // NOLINT: a box is a domain
  /// The active voxels, tiles included. A region that fills its bounding box is that box.
  /// @throw InvalidInput if there are none, or coordinates are beyond kMaxCoordinate.
  explicit Domain(const MaskTree& region);

  /// Takes voxels that are known to be such a region, with their bounding box.
  Domain(std::shared_ptr<const MaskTree> region, const CoordBBox& box)
      : box_(box), region_(std::move(region)) {}

  const CoordBBox& box() const { return box_; }  ///< bounds B
  bool isBox() const { return !region_; }
  const std::shared_ptr<const MaskTree>& region() const { return region_; }  ///< null for a box
  /// Voxels of B; beyond 64 bits in boxes far larger than any object.
  __int128 voxelCount() const;
  /// The axis along which B is one voxel thick: the first, if there are several.
  std::optional<int> flatAxis() const;
  bool isInside(const Coord& voxel) const;  ///< one look-up in a tree
  /// The voxels of B that lie in another one, such as a box. @throw InvalidInput if there are none.
  Domain within(const Domain& other) const;

  friend bool operator==(const Domain& a, const Domain& b);
  friend bool operator!=(const Domain& a, const Domain& b) { return !(a == b); }

 private:
  CoordBBox box_;
  std::shared_ptr<const MaskTree> region_;
};

}  // namespace vdb_madf
