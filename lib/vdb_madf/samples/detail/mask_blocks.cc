// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/samples/detail/mask_blocks.h"

#include <map>

namespace vdb_madf::detail {

namespace {

Coord blockCounts(const Coord& size) {
  const int edge = MaskBlocks::kEdge;
  return {(size.x() + edge - 1) / edge, (size.y() + edge - 1) / edge, (size.z() + edge - 1) / edge};
}

}  // namespace

MaskBlocks::MaskBlocks(const Coord& size)
    : size_(size),
      counts_(blockCounts(size)),
      nodes_(size_t(counts_.x()) * counts_.y() * counts_.z()) {}

CoordBBox MaskBlocks::box(size_t block) const {
  const int z = int(block % counts_.z());
  const int y = int(block / counts_.z() % counts_.y());
  const int x = int(block / counts_.z() / counts_.y());
  const Coord lower(x * kEdge, y * kEdge, z * kEdge);
  return {lower, Coord::minComponent(lower.offsetBy(kEdge - 1), size_.offsetBy(-1))};
}

CoordBBox MaskBlocks::blocksOf(const CoordBBox& voxels) const {
  const Coord lower = Coord::maxComponent(voxels.min(), Coord(0));
  const Coord upper = Coord::minComponent(voxels.max(), size_.offsetBy(-1));
  return {Coord(lower.x() / kEdge, lower.y() / kEdge, lower.z() / kEdge),
          Coord(upper.x() / kEdge, upper.y() / kEdge, upper.z() / kEdge)};
}

MaskBlocks::Node& MaskBlocks::node(size_t block) {
  if (!nodes_[block]) nodes_[block] = std::make_unique<Node>(box(block).min(), false, false);
  return *nodes_[block];
}

void MaskBlocks::makeTile(Node& node, const Coord& leafOrigin) {
  node.addTile(Node::coordToOffset(leafOrigin), true, true);
}

MaskTree::Ptr MaskBlocks::takeTree() {
  using Upper = MaskTree::RootNodeType::ChildNodeType;
  auto tree = std::make_shared<MaskTree>();
  std::map<Coord, Upper*> uppers;
  for (auto& node : nodes_) {
    if (!node) continue;
    const Coord origin = node->origin() & ~int(Upper::DIM - 1);
    Upper*& upper = uppers[origin];
    if (!upper) {
      upper = new Upper(origin, false, false);
      tree->root().addChild(upper);
    }
    upper->addChild(node.release());
  }
  return tree;
}

}  // namespace vdb_madf::detail
