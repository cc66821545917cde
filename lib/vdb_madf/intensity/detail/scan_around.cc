// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/intensity/detail/scan_around.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>

#include "vdb_madf/base/errors.h"
#include "vdb_madf/grids/detail/leaf_nodes.h"
#include "vdb_madf/images/detail/header_checks.h"
#include "vdb_madf/images/detail/sample_conversion.h"

namespace vdb_madf::detail {

using FloatTree = FloatGrid::TreeType;

FloatTree::Ptr readAround(const std::vector<CoordBBox>& boxes, GrayScan& scan,
                          Interrupter* interrupter) {
  auto tree = std::make_shared<FloatTree>(0.0F);
  for (const CoordBBox& part : boxes)
    forEachLeafOrigin(part, [&](const Coord& origin) { tree->touchLeaf(origin); });
  std::map<int, std::vector<FloatTree::LeafNodeType*>> layers;
  for (auto leaf = tree->beginLeaf(); leaf; ++leaf)
    layers[leaf->origin().z()].push_back(leaf.getLeaf());
  const CoordBBox box = scan.box();
  const Coord size = box.dim();
  std::vector<char> bytes(size_t(sliceBytes(scan.image->info())) * size_t(std::min(8, size.z())));
  int done = 0;
  for (const auto& layer : layers) {
    const int z = layer.first;
    const std::vector<FloatTree::LeafNodeType*>& leaves = layer.second;
    if (interrupter && interrupter->wasInterrupted(done++ * 100 / int(layers.size())))
      throw Interrupted();
    const int first = std::max(z, box.min().z()), last = std::min(z + 7, box.max().z());
    scan.image->read(first - box.min().z(), last - first + 1, bytes.data());
    withSampleType(scan.image->info().type, [&](auto type) {
      const auto* samples = reinterpret_cast<const decltype(type)*>(bytes.data());
      for (auto* leaf : leaves) {
        CoordBBox part = leaf->getNodeBoundingBox();
        part.intersect(box);
        for (auto p = part.begin(); p; ++p) {
          const Coord from = *p - Coord(box.min().x(), box.min().y(), first);
          leaf->setValueOnly(
              *p, float(samples[(size_t(from.z()) * size_t(size.y()) + size_t(from.y())) *
                                    size_t(size.x()) +
                                size_t(from.x())]));
        }
      }
    });
  }
  return tree;
}

void forgetOutside(const MaskTree& region, FloatTree& gray) {
  for (auto leaf = gray.beginLeaf(); leaf; ++leaf) {
    const auto* inside = region.probeConstLeaf(leaf->origin());
    const bool all = !inside && region.isValueOn(leaf->origin());
    for (openvdb::Index i = 0; !all && i < FloatTree::LeafNodeType::SIZE; ++i)
      if (!inside || !inside->isValueOn(i)) leaf->setValueOnly(i, NAN);
  }
}

}  // namespace vdb_madf::detail
