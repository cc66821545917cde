// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/samples/detail/object_change.h"

#include <openvdb/tree/ValueAccessor.h>

#include <algorithm>

#include "vdb_madf/base/detail/parallel.h"
#include "vdb_madf/grids/grid_metadata.h"
#include "vdb_madf/samples/detail/carried_labels.h"
#include "vdb_madf/samples/detail/mask_blocks.h"

namespace vdb_madf::detail {

ObjectChange::ObjectChange(const Sample& sample)
    : object_(sample.object->tree()), domain_(storedDomain(*sample.object)->box()) {}

MaskTree::Ptr ObjectChange::apply(Interrupter* interrupter) const {
  MaskBlocks blocks(domain_.dim());
  parallelForEach(blocks.count(), 1, interrupter, [&](size_t block) {
    const FloatBox field = height(blocks.box(block));
    size_t i = 0;
    for (auto p = field.box.begin(); p; ++p, ++i)
      if (field.values[i] >= 0) blocks.node(block).touchLeaf(*p)->setValueOn(*p);
  });
  return blocks.takeTree();
}

FloatBox ObjectChange::indicatorIn(CoordBBox box, int margin) const {
  box.expand(margin);
  FloatBox field(box);
  const openvdb::tree::ValueAccessor<const MaskTree> values(object_);
  const auto inside = [&](int i, int axis) {
    return std::clamp(i, domain_.min()[axis], domain_.max()[axis]);
  };
  for (int x = box.min().x(); x <= box.max().x(); ++x)
    for (int y = box.min().y(); y <= box.max().y(); ++y) {
      float* row = field.values.data() + field.offset(x, y, box.min().z());
      for (int z = box.min().z(); z <= box.max().z(); ++z)
        *row++ = values.isValueOn({inside(x, 0), inside(y, 1), inside(z, 2)});
    }
  return field;
}

Sample changed(const Sample& sample, const ObjectChange& change, int reach,
               Interrupter* interrupter) {
  Sample result;
  result.object = MaskGrid::create(change.apply(interrupter));
  if (sample.truth)
    result.truth = Int32Grid::create(
        carriedLabels(sample.truth->tree(), result.object->tree(), reach, interrupter));
  return result;
}

}  // namespace vdb_madf::detail
