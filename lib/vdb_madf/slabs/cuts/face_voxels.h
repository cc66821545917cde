// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <algorithm>
#include <tuple>
#include <vector>

#include "vdb_madf/grids/grid_types.h"

// What is known of the voxels of a layer beside a cut: structs with the coordinates x and y, in the
// order of leaf columns, then x, y.

namespace vdb_madf::detail {

template <typename A, typename B>
bool faceLess(const A& a, const B& b) {
  return std::make_tuple(a.x & ~7, a.y & ~7, a.x, a.y) <
         std::make_tuple(b.x & ~7, b.y & ~7, b.x, b.y);
}

/// The voxel of a face at the x and y of p; null if there is none.
template <typename Voxel>
const Voxel* findOnFace(const std::vector<Voxel>& face, const Coord& p) {
  Voxel wanted{};
  wanted.x = p.x();
  wanted.y = p.y();
  const auto found = std::lower_bound(face.begin(), face.end(), wanted, faceLess<Voxel, Voxel>);
  return found != face.end() && !faceLess(wanted, *found) ? &*found : nullptr;
}

/// f(below, above) for the voxels that face each other across a cut.
template <typename Voxel, typename F>
void forEachFacing(const std::vector<Voxel>& below, const std::vector<Voxel>& above, const F& f) {
  auto b = above.begin();
  for (const Voxel& a : below) {
    while (b != above.end() && faceLess(*b, a)) ++b;
    if (b == above.end()) return;
    if (!faceLess(a, *b)) f(a, *b);
  }
}

}  // namespace vdb_madf::detail
