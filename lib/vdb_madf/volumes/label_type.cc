// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/volumes/label_type.h"

#include <algorithm>
#include <limits>
#include <mutex>

#include "vdb_madf/base/detail/parallel.h"
#include "vdb_madf/grids/detail/leaf_nodes.h"
#include "vdb_madf/leaves/detail/voxels.h"

namespace vdb_madf {

SampleType labelType(const Int32Grid& grid) {
  using Leaf = Int32Tree::LeafNodeType;
  constexpr int32_t kMost = std::numeric_limits<uint16_t>::max();
  const auto leaves = detail::leavesOf(grid.tree());
  int32_t min = 0, max = 0;  // of inactive voxels
  std::mutex mutex;
  detail::parallelFor(leaves.size(), detail::kLeafGrain, nullptr, [&](size_t begin, size_t end) {
    int32_t low = std::numeric_limits<int32_t>::max(), high = std::numeric_limits<int32_t>::min();
    for (size_t i = begin; i < end; ++i) {
      // Where all values that are stored fit, it does not matter which of them are active.
      const int32_t* values = leaves[i]->buffer().data();
      const auto [lowest, highest] = std::minmax_element(values, values + Leaf::SIZE);
      if (*lowest >= 0 && *highest <= kMost) continue;
      for (auto voxel = leaves[i]->cbeginValueOn(); voxel; ++voxel) {
        low = std::min(low, *voxel);
        high = std::max(high, *voxel);
      }
    }
    const std::lock_guard<std::mutex> lock(mutex);
    min = std::min(min, low);
    max = std::max(max, high);
  });
  auto tile = grid.tree().cbeginValueOn();
  tile.setMaxDepth(tile.getLeafDepth() - 1);
  for (; tile; ++tile) {
    min = std::min(min, *tile);
    max = std::max(max, *tile);
  }
  if (min < 0) return SampleType::int32;
  return max <= kMost ? SampleType::uint16 : SampleType::uint32;
}

}  // namespace vdb_madf
