// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <random>

#include "support/other_grids.h"

// Grids that went through a file, compared with those that were written.

namespace vdb_madf::test {

using openvdb::GridBase;

/// Leaves full of random values: they do not compress.
inline Int32Grid::Ptr noise(int leaves, uint32_t seed = 1) {
  std::mt19937 random(seed);
  const auto grid = Int32Grid::create();
  for (int i = 0; i < leaves; ++i) {
    auto* leaf = grid->tree().touchLeaf(Coord(8 * (i % 16), 8 * (i / 16 % 16), 8 * (i / 256)));
    for (openvdb::Index j = 0; j < 512; ++j) leaf->setValueOn(j, int32_t(random()));
  }
  grid->setName("noise");
  return grid;
}

template <typename GridType>
bool sameTree(const GridBase& a, const GridBase& b) {
  const auto* first = dynamic_cast<const GridType*>(&a);
  const auto* second = dynamic_cast<const GridType*>(&b);
  if (!first || !second || !first->tree().hasSameTopology(second->tree())) return false;
  // Inactive values and tiles too.
  if (first->background() != second->background()) return false;
  auto i = first->tree().cbeginValueAll(), j = second->tree().cbeginValueAll();
  for (; i && j; ++i, ++j)
    if (*i != *j || i.getCoord() != j.getCoord() || i.isValueOn() != j.isValueOn()) return false;
  return !i && !j;
}

inline bool sameTree(const GridBase& a, const GridBase& b) {
  return sameTree<BoolGrid>(a, b) || sameTree<MaskGrid>(a, b) || sameTree<Int32Grid>(a, b) ||
         sameTree<FloatGrid>(a, b) || sameTree<Vec3sGrid>(a, b) || sameTree<DoubleGrid>(a, b) ||
         sameTree<Int64Grid>(a, b);
}

/// Metadata of `a` is in `b`.
inline bool hasMetadataOf(const GridBase& a, const GridBase& b) {
  for (auto i = a.beginMeta(); i != a.endMeta(); ++i) {
    const auto other = b[i->first];
    if (!other || *other != *i->second) return false;
  }
  return true;
}

inline bool same(const GridBase& a, const GridBase& b) {
  return a.getName() == b.getName() && sameTree(a, b) && a.transform() == b.transform() &&
         hasMetadataOf(a, b);
}

}  // namespace vdb_madf::test
