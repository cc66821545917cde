// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/grids/object_mask.h"

#include <type_traits>

#include "vdb_madf/base/errors.h"
#include "vdb_madf/base/limits.h"
#include "vdb_madf/grids/detail/leaf_nodes.h"
#include "vdb_madf/grids/detail/mask_sets.h"
#include "vdb_madf/grids/detail/number_grids.h"
#include "vdb_madf/grids/grid_metadata.h"
#include "vdb_madf/grids/object_keys.h"

namespace vdb_madf {

namespace {

using MaskLeaf = MaskTree::LeafNodeType;
using Word = openvdb::Index64;
constexpr openvdb::Index kWords = MaskLeaf::NUM_VALUES / 64;
constexpr size_t kLeavesPerChunk = 256;

/// Bit i of word n says whether voxel 64 n + i of the leaf passes. `test(value, active)`.
template <typename Leaf, typename Test>
Word objectWord(const Leaf& leaf, openvdb::Index n, const Test& test) {
  using Value = typename Leaf::ValueType;
  const Word active = leaf.getValueMask().template getWord<Word>(n);
  if constexpr (std::is_same_v<Value, bool>) {
    Word values = active;  // of a mask leaf
    if constexpr (!std::is_same_v<Leaf, MaskLeaf>) {
      values = 0;
      for (openvdb::Index i = 0; i < 64; ++i) values |= Word(leaf.getValue(64 * n + i)) << i;
    }
    return (test(true, true) ? active & values : 0) | (test(false, true) ? active & ~values : 0) |
           (test(true, false) ? ~active & values : 0) |
           (test(false, false) ? ~active & ~values : 0);
  } else {
    const Value* values = leaf.buffer().data() + 64 * n;
    Word word = 0;
    for (openvdb::Index i = 0; i < 64; ++i)
      word |= Word(test(values[i], (active >> i & 1) != 0)) << i;
    return word;
  }
}

/// The voxels that the tree lists, in tiles or leaves, and that pass.
template <typename Tree, typename Test>
MaskTree::Ptr listedVoxels(const Tree& tree, const Test& test) {
  auto mask = std::make_shared<MaskTree>();
  auto tile = tree.cbeginValueAll();
  tile.setMaxDepth(tile.getLeafDepth() - 1);
  for (; tile; ++tile)
    if (test(*tile, tile.isValueOn()))
      mask->addTile(Tree::DEPTH - 1 - tile.getDepth(), tile.getCoord(), true, true);

  const auto leaves = detail::leavesOf(tree);
  detail::addLeaves(*mask, leaves.size(), kLeavesPerChunk, nullptr, [&](size_t i) {
    std::unique_ptr<MaskLeaf> packed;
    openvdb::util::NodeMask<3> bits;
    for (openvdb::Index n = 0; n < kWords; ++n)
      bits.template getWord<Word>(n) = objectWord(*leaves[i], n, test);
    if (bits.isOff()) return packed;
    packed = std::make_unique<MaskLeaf>(leaves[i]->origin(), false);
    packed->setValueMask(bits);
    return packed;
  });
  return mask;
}

template <typename Value>
bool isNumber(const Value& value) {
  return value == value;
}

/// Only the faces of a box cost leaf nodes, the rest is tiles.
MaskTree::Ptr box(const CoordBBox& extent) {
  constexpr double kLeaf = 8;
  const double a = extent.dim().x() / kLeaf + 1, b = extent.dim().y() / kLeaf + 1,
               c = extent.dim().z() / kLeaf + 1;
  if (2 * (a * b + b * c + c * a) > double(kMaxLeaves))
    throw InvalidInput("the domain is too large to invert a selection in it: crop it");
  auto tree = std::make_shared<MaskTree>();
  tree->sparseFill(extent, true, true);
  return tree;
}

/// All voxels of the domain that pass, be they listed in the tree or background.
template <typename Tree, typename Test>
MaskTree::Ptr voxelsOfDomain(const Tree& tree, const CoordBBox& extent, const Test& test) {
  MaskTree::Ptr mask = box(extent);
  if (test(tree.background(), false)) {
    const auto fails = [&](const auto& value, bool active) { return !test(value, active); };
    detail::subtract(*mask, *listedVoxels(tree, fails));
  } else {
    detail::intersect(*mask, *listedVoxels(tree, test));
  }
  return mask;
}

template <typename Grid>
MaskTree::Ptr objectOf(const Grid& grid, std::optional<Selection> selection) {
  using Value = typename Grid::ValueType;
  if (std::is_same_v<Value, float> && selection) selection = selection->ofFloats();
  const auto& tree = grid.tree();
  if constexpr (!std::is_same_v<Value, bool>) {
    if (!selection && grid.getGridClass() == openvdb::GRID_LEVEL_SET) {
      if (tree.background() < 0)
        throw InvalidInput("grid '" + grid.getName() + "': its level set has no outside");
      return listedVoxels(tree, [](Value value, bool) { return value < 0; });
    }
  }
  if (!selection)
    return listedVoxels(tree, [](Value value, bool active) { return active && value > Value(0); });
  const auto accepts = [&](Value value, bool active) {
    return active ? (*selection)(double(value)) : selection->invert && isNumber(value);
  };
  if (!selection->invert) return listedVoxels(tree, accepts);
  const auto extent = storedDomain(grid);
  if (!extent)
    throw InvalidInput("grid '" + grid.getName() +
                       "': an inverted selection needs a domain, which this grid does not carry");
  const MaskTree::Ptr object = voxelsOfDomain(tree, extent->box(), accepts);
  if (!extent->isBox()) detail::intersect(*object, *extent->region());
  return object;
}

}  // namespace

MaskGrid::Ptr objectMask(const openvdb::GridBase& grid, const std::optional<Selection>& selection) {
  MaskTree::Ptr mask;
  if (!grid.apply<detail::NumberGrids>(
          [&](const auto& numbers) { mask = objectOf(numbers, selection); }))
    throw InvalidInput("grid '" + grid.getName() + "' of type " + grid.valueType() +
                       " has no object: only " + detail::kNumberGrids + " have");
  const auto object = MaskGrid::create(mask);
  object->setName("object");
  copyProvenance(grid, *object);
  if (selection)  // what made the first object does not tell how this one was made
    for (const char* key : {kObjectKey, kThresholdKey, kThresholdLowKey}) object->removeMeta(key);
  return object;
}

BoolGrid::Ptr toBoolGrid(const MaskGrid& mask) {
  using BoolTree = BoolGrid::TreeType;
  const auto grid = BoolGrid::create(
      std::make_shared<BoolTree>(mask.tree(), false, true, openvdb::TopologyCopy()));
  grid->tree().prune();
  for (auto meta = mask.beginMeta(); meta != mask.endMeta(); ++meta)
    grid->insertMeta(meta->first, *meta->second);
  grid->setTransform(mask.transform().copy());
  return grid;
}

}  // namespace vdb_madf
