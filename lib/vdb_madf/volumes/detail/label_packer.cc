// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/volumes/detail/label_packer.h"

#include <memory>
#include <vector>

#include "vdb_madf/base/detail/parallel.h"
#include "vdb_madf/images/detail/sample_conversion.h"
#include "vdb_madf/leaves/detail/voxels.h"

namespace vdb_madf::detail {

namespace {

using LabelLeaf = Int32Tree::LeafNodeType;

/// The leaf at `origin`; null if it holds no label.
std::unique_ptr<LabelLeaf> makeLeaf(const int32_t* labels, const CoordBBox& slab,
                                    const Coord& origin) {
  CoordBBox box = CoordBBox::createCube(origin, kLeafSide);
  box.intersect(slab);
  const Coord size = slab.dim();
  std::unique_ptr<LabelLeaf> leaf;
  for (int z = box.min().z(); z <= box.max().z(); ++z) {
    for (int y = box.min().y(); y <= box.max().y(); ++y) {
      const size_t row = size_t(z - slab.min().z()) * size_t(size.y()) + size_t(y - slab.min().y());
      const int32_t* label =
          labels + row * size_t(size.x()) + size_t(box.min().x() - slab.min().x());
      for (int x = box.min().x(); x <= box.max().x(); ++x, ++label) {
        if (*label == 0) continue;
        if (!leaf) leaf = std::make_unique<LabelLeaf>(origin, 0, false);
        leaf->setValueOn(LabelLeaf::coordToOffset(Coord(x, y, z)), *label);
      }
    }
  }
  return leaf;
}

void addLeaves(const int32_t* labels, const CoordBBox& slab, Int32Tree& tree) {
  const Coord first = slab.min() & ~(kLeafSide - 1);
  std::vector<std::vector<std::unique_ptr<LabelLeaf>>> rows(
      size_t((slab.max().y() >> 3) - (slab.min().y() >> 3)) + 1);
  parallelForEach(rows.size(), 1, nullptr, [&](size_t row) {
    for (int x = first.x(); x <= slab.max().x(); x += kLeafSide)
      if (auto leaf = makeLeaf(labels, slab, Coord(x, first.y() + int(row) * kLeafSide, first.z())))
        rows[row].push_back(std::move(leaf));
  });
  openvdb::tree::ValueAccessor<Int32Tree> accessor(tree);
  for (auto& row : rows)
    for (auto& leaf : row) accessor.addLeaf(leaf.release());
}

}  // namespace

void packLabels(const std::string& name, const void* samples, SampleType type,
                const CoordBBox& slab, Int32Tree& tree) {
  if (type == SampleType::int32) return addLeaves(static_cast<const int32_t*>(samples), slab, tree);
  std::vector<int32_t> labels(slab.volume());
  withSampleType(type, [&](auto sample) {
    convertSamples(name, static_cast<const decltype(sample)*>(samples), labels.size(),
                   SampleType::int32, labels.data());
  });
  addLeaves(labels.data(), slab, tree);
}

}  // namespace vdb_madf::detail
