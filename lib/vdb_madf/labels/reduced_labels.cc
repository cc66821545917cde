// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/labels/reduced_labels.h"

#include <algorithm>
#include <memory>
#include <vector>

#include "vdb_madf/base/errors.h"
#include "vdb_madf/grids/grid_metadata.h"
#include "vdb_madf/labels/detail/reduction.h"

namespace vdb_madf {

namespace {

using Leaf = Int32Tree::LeafNodeType;

}  // namespace

int reductionFor(const CoordBBox& box, int maxDim) {
  if (maxDim < 1) throw InvalidInput("the largest size must be 1 voxel or more");
  if (box.empty()) return 1;
  for (int factor = 1; factor <= kMaxReduction; ++factor) {
    const Coord size = detail::floorDiv(box.max(), factor) - detail::floorDiv(box.min(), factor);
    if (std::max({size.x(), size.y(), size.z()}) < maxDim) return factor;
  }
  throw InvalidInput("a reduction of more than 256 would be needed: allow a larger size");
}

Int32Grid::Ptr reduceLabels(const Int32Grid& labels, int factor, Interrupter* interrupter) {
  const detail::Reduction reduction(labels, factor, storedDomain(labels));
  std::vector<std::unique_ptr<Leaf>> leaves(reduction.leafCount());
  reduction.run(
      [&](size_t n, const Coord& origin, const detail::Cells& cells) {
        leaves[n] = detail::leafAt<Int32Grid>(origin);
        for (openvdb::Index i = 0; i < Leaf::SIZE; ++i)
          if (cells[i].majority) leaves[n]->setValueOn(i, cells[i].majority);
      },
      interrupter);
  return detail::gather<Int32Grid>(leaves, labels, factor, labels.getName());
}

Int32Grid::Ptr reduceLabels(const LabelSlabs& labels, int factor, Interrupter* interrupter) {
  const Int32Grid::Ptr whole = reduceLabels(*labels.about, factor, interrupter);
  const auto add = [&](const Int32Grid& part) {
    whole->tree().merge(reduceLabels(part, factor, interrupter)->tree());
  };
  detail::forEachPart(labels, factor, add, interrupter);
  return whole;
}

openvdb::math::Transform::Ptr transformInUnitOf(const Int32Grid& labels, const Int32Grid& reduced) {
  const auto transform = reduced.transform().copy();
  const auto own = storedVoxelSize(reduced), wanted = storedVoxelSize(labels);
  if (own && wanted) detail::convertUnit(own->unit(), wanted->unit(), *transform);
  return transform;
}

}  // namespace vdb_madf
