// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/report/detail/packed_labels.h"

#include <algorithm>

#include "vdb_madf/base/detail/sorted.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/grids/detail/grid_slabs.h"
#include "vdb_madf/report/detail/packed_bytes.h"

namespace vdb_madf::detail {

namespace {

constexpr int kSlices = 8;

/// Places in `ids` from 1 on; neighbors mostly hold the same label.
class Places {
 public:
  explicit Places(const std::vector<int32_t>& ids) : ids_(ids) {}
  uint32_t operator()(int32_t label) {
    if (label == label_) return place_;
    label_ = label;
    const auto found = findSorted(ids_, label);
    return place_ = found ? uint32_t(*found) + 1 : 0;
  }

 private:
  const std::vector<int32_t>& ids_;
  int32_t label_ = 0;
  uint32_t place_ = 0;
};

}  // namespace

std::string packLabels(const Int32Grid& labels, const CoordBBox& box,
                       const std::vector<int32_t>& ids, Interrupter* interrupter) {
  PackedBytes packed;
  if (box.empty()) return packed.text();
  const GridSlabs<Int32Tree, ActiveValue> slabs(labels.tree(), box);
  Places places(ids);
  uint64_t run = 0;
  uint32_t held = 0;
  const auto endRun = [&] {
    if (run == 0) return;
    packed.variable(run);
    packed.variable(held);
    run = 0;
  };
  std::vector<int32_t> slab;
  for (int z = box.min().z(); z <= box.max().z(); z += kSlices) {
    if (interrupter && interrupter->wasInterrupted()) throw Interrupted();
    const int count = std::min(kSlices, box.max().z() - z + 1);
    slab.resize(size_t(box.dim().x()) * size_t(box.dim().y()) * size_t(count));
    slabs.read(z, count, slab.data());
    for (const int32_t label : slab) {
      const uint32_t place = places(label);
      if (place != held) endRun();
      held = place;
      ++run;
    }
  }
  endRun();
  return packed.text();
}

}  // namespace vdb_madf::detail
