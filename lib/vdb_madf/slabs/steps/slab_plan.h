// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <algorithm>
#include <vector>

#include "vdb_madf/slabs/cuts/site_offers.h"
#include "vdb_madf/slabs/cuts/slab_body.h"
#include "vdb_madf/slabs/store/slab_store.h"
#include "vdb_madf/slabs/team.h"

namespace vdb_madf::detail {

/// Where the object is cut, and which slabs a member of the team works on.
struct SlabPlan {
  const SlabObject& object;
  const Team& team;

  size_t slabCount() const { return object.slabCount(); }
  int begin(size_t slab) const { return object.cuts[slab]; }
  int end(size_t slab) const { return object.cuts[slab + 1]; }
  Cut cut(size_t slab, bool isUpper) const { return {begin(slab), end(slab), isUpper}; }
  size_t slabOf(int z) const {
    const std::vector<int>& cuts = object.cuts;
    return size_t(std::upper_bound(cuts.begin(), cuts.end(), z) - cuts.begin()) - 1;
  }

  /// Slabs of this member: firstOwn() <= s < endOwn().
  size_t firstOwn() const { return team.firstSlab(team.member(), slabCount()); }
  size_t endOwn() const { return team.firstSlab(team.member() + 1, slabCount()); }
  bool isRoot() const { return team.member() == 0; }
};

}  // namespace vdb_madf::detail
