// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include "vdb_madf/grids/grid_types.h"

namespace vdb_madf::detail {

/// f(box) for every active tile of a tree, whatever its value.
template <typename Tree, typename F>
void forEachActiveTile(const Tree& tree, const F& f) {
  auto tile = tree.cbeginValueOn();
  tile.setMaxDepth(tile.getLeafDepth() - 1);
  for (; tile; ++tile) f(tile.getBoundingBox());
}

}  // namespace vdb_madf::detail
