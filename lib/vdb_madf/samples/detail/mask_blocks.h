// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <memory>
#include <vector>

#include "vdb_madf/grids/grid_types.h"

namespace vdb_madf::detail {

/// A mask over [0, size - 1] under construction, in blocks of 128^3 voxels. Each block is a node of
/// the tree to be, so that threads fill different blocks without locks.
class MaskBlocks {
 public:
  using Node = MaskTree::RootNodeType::ChildNodeType::ChildNodeType;
  using Leaf = MaskTree::LeafNodeType;
  static constexpr int kEdge = Node::DIM;

  explicit MaskBlocks(const Coord& size);

  size_t count() const { return nodes_.size(); }
  /// The voxels of a block that lie in the box.
  CoordBBox box(size_t block) const;
  /// Blocks that meet the voxels [lower, upper], which must overlap the box: first and last index
  /// along each axis.
  CoordBBox blocksOf(const CoordBBox& voxels) const;
  size_t indexOf(const Coord& block) const {
    return (size_t(block.x()) * counts_.y() + block.y()) * counts_.z() + block.z();
  }

  /// The node of a block, made at first use.
  Node& node(size_t block);
  /// Null if the block is empty.
  const Node* probe(size_t block) const { return nodes_[block].get(); }
  /// Turns a full leaf into a tile: 96 bytes less for each 512 voxels.
  static void makeTile(Node& node, const Coord& leafOrigin);

  /// The finished tree; the blocks are empty afterwards.
  MaskTree::Ptr takeTree();

 private:
  Coord size_, counts_;
  std::vector<std::unique_ptr<Node>> nodes_;
};

}  // namespace vdb_madf::detail
