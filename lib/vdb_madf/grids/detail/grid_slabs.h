// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <algorithm>
#include <type_traits>
#include <vector>

#include "vdb_madf/base/detail/parallel.h"
#include "vdb_madf/grids/detail/leaf_nodes.h"
#include "vdb_madf/grids/grid_types.h"

namespace vdb_madf::detail {

/// `count` slices of a box, from z on.
inline CoordBBox slicesOf(CoordBBox box, int z, int count) {
  box.min().z() = z;
  box.max().z() = z + count - 1;
  return box;
}

/// What a voxel holds, active or not.
struct StoredValue {
  template <typename T>
  T operator()(T value, bool) const {
    return value;
  }
};

/// What an active voxel holds; 0 of others, as readers of masks and labels have it.
struct ActiveValue {
  template <typename T>
  T operator()(T value, bool active) const {
    return active ? value : T(0);
  }
};

/// The values of a tree over a box, slab by slab: one per voxel, x fastest. A voxel's value is
/// ValueOf()(value, active); what lies outside of tiles and leaves is inactive background.
template <typename Tree, typename ValueOf = StoredValue>
class GridSlabs {
 public:
  using Leaf = typename Tree::LeafNodeType;
  /// Bits are handed over as bytes.
  using Value = std::conditional_t<std::is_same_v<typename Tree::ValueType, bool>, uint8_t,
                                   typename Tree::ValueType>;

  /// The tree must live as long.
  GridSlabs(const Tree& tree, const CoordBBox& box)
      : box_(box), background_(ValueOf()(tree.background(), false)) {
    layers_.resize(layerOf(box.max().z()) + 1);
    for (const Leaf* leaf : leavesOf(tree))
      if (leaf->getNodeBoundingBox().hasOverlap(box))
        layers_[layerOf(leaf->origin().z())].leaves.push_back(leaf);
    auto tile = tree.cbeginValueAll();
    tile.setMaxDepth(tile.getLeafDepth() - 1);
    for (; tile; ++tile) addTile(tile.getBoundingBox(), ValueOf()(*tile, tile.isValueOn()));
  }

  /// Reads `count` slices from z on, all within the box.
  void read(int z, int count, Value* values) const {
    readLayers(z, count, values, [](size_t pieces, const auto& body) { body(0, pieces); });
  }
  void readInParallel(int z, int count, Value* values) const {
    readLayers(z, count, values, [](size_t pieces, const auto& body) {
      parallelFor(pieces, kPiecesPerChunk, nullptr, body);
    });
  }

 private:
  static constexpr int kLeaf = 8;
  static constexpr size_t kPiecesPerChunk = 64;

  struct Tile {
    CoordBBox box;
    Value value;
  };
  struct Layer {
    std::vector<const Leaf*> leaves;
    std::vector<Tile> tiles;
  };

  size_t layerOf(int z) const { return size_t((z >> 3) - (box_.min().z() >> 3)); }

  void addTile(CoordBBox box, Value value) {
    box.intersect(box_);
    if (box.empty() || value == background_) return;
    for (size_t layer = layerOf(box.min().z()); layer <= layerOf(box.max().z()); ++layer)
      layers_[layer].tiles.push_back({box, value});
  }

  template <typename Run>
  void readLayers(int z, int count, Value* values, const Run& run) const {
    const CoordBBox slab = slicesOf(box_, z, count);
    std::fill(values, values + slab.volume(), background_);
    for (size_t number = layerOf(z); number <= layerOf(slab.max().z()); ++number) {
      const Layer& layer = layers_[number];
      // A tile reaches into other layers.
      CoordBBox part = slab;
      const int bottom = ((z >> 3) + int(number - layerOf(z))) * kLeaf;
      part.min().z() = std::max(part.min().z(), bottom);
      part.max().z() = std::min(part.max().z(), bottom + kLeaf - 1);
      run(layer.tiles.size(), [&](size_t begin, size_t end) {
        for (size_t i = begin; i < end; ++i) fillTile(layer.tiles[i], part, slab, values);
      });
      run(layer.leaves.size(), [&](size_t begin, size_t end) {
        for (size_t i = begin; i < end; ++i) copyLeaf(*layer.leaves[i], slab, values);
      });
    }
  }

  static size_t place(const CoordBBox& box, int x, int y, int z) {
    const Coord size = box.dim(), p = Coord(x, y, z) - box.min();
    return (size_t(p.z()) * size_t(size.y()) + size_t(p.y())) * size_t(size.x()) + size_t(p.x());
  }

  static void fillTile(const Tile& tile, CoordBBox part, const CoordBBox& slab, Value* values) {
    part.intersect(tile.box);
    for (int z = part.min().z(); z <= part.max().z(); ++z)
      for (int y = part.min().y(); y <= part.max().y(); ++y)
        std::fill_n(values + place(slab, part.min().x(), y, z), part.dim().x(), tile.value);
  }

  static void copyLeaf(const Leaf& leaf, const CoordBBox& slab, Value* values) {
    CoordBBox part = leaf.getNodeBoundingBox();
    part.intersect(slab);
    for (int z = part.min().z(); z <= part.max().z(); ++z)
      for (int y = part.min().y(); y <= part.max().y(); ++y) {
        Value* to = values + place(slab, part.min().x(), y, z);
        openvdb::Index offset = Leaf::coordToOffset(Coord(part.min().x(), y, z));
        for (int x = part.min().x(); x <= part.max().x(); ++x, offset += kLeaf * kLeaf)
          *to++ = ValueOf()(leaf.getValue(offset), leaf.isValueOn(offset));
      }
  }

  CoordBBox box_;
  Value background_;
  std::vector<Layer> layers_;
};

}  // namespace vdb_madf::detail
