// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstdint>
#include <tuple>
#include <vector>

#include "vdb_madf/leaves/leaf_index.h"
#include "vdb_madf/method/kernels/lower_envelope.h"
#include "vdb_madf/method/kernels/power_windows.h"

namespace vdb_madf::detail {

/// A medial ball of another slab.
struct ForeignSite {
  Coord position;
  int32_t squaredRadius = 0;
};

/// Orders sites by leaf column, then column, then z.
struct ColumnOrder {
  bool operator()(const ForeignSite& a, const ForeignSite& b) const {
    return placeOf(a.position) < placeOf(b.position);
  }

 private:
  static std::tuple<int, int, int, int> placeOf(const Coord& p) {
    return {p.x() & ~7, p.y() & ~7, (p.x() & 7) * 8 + (p.y() & 7), p.z()};
  }
};

/// The sites beyond the cuts of a slab that may win in it: all those in line along z with an object
/// voxel at a cut, joined to it by the object.
class ForeignSites {
 public:
  /// Takes each site at most once, in ColumnOrder. Names their leaves in the index of the slab
  /// begin <= z < end.
  ForeignSites(const std::vector<ForeignSite>& below, const std::vector<ForeignSite>& above,
               int begin, int end, LeafIndex& index);

  /// Adds the sites in line with the pencil of `length` voxels along z that starts at `origin`.
  template <typename Key>
  void addTo(const Coord& origin, int length, EnvelopeRows<Key>& rows) const;

  /// Adds the sites in line with lines along z, as far as these reach.
  void addTo(const Coord& origin, int shift, KeyLines& lines) const;

  int32_t largestSquaredRadius() const { return largest_; }
  /// Voxels along z from a cut to the farthest of them.
  int reach() const { return reach_; }

 private:
  struct Named {
    ForeignSite site;
    VoxelId id;
  };
  void name(LeafIndex& index);

  int begin_, end_;
  int32_t largest_ = 0;
  int reach_ = 0;
  std::vector<Named> below_, above_;  // in ColumnOrder
};

}  // namespace vdb_madf::detail
