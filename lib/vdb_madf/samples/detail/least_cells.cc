// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/samples/detail/least_cells.h"
#include "vdb_madf/leaves/detail/voxels.h"

#include <atomic>

namespace vdb_madf::detail {

void numberOwners(Int32Tree& labels, size_t count, Interrupter* interrupter) {
  const auto leaves = leavesOf(labels);
  std::vector<std::atomic<bool>> owns(count + 1);
  parallelForEach(leaves.size(), kLeafGrain, interrupter, [&](size_t i) {
    for (auto voxel = leaves[i]->cbeginValueOn(); voxel; ++voxel)
      owns[size_t(*voxel)].store(true, std::memory_order_relaxed);
  });
  std::vector<int32_t> number(count + 1);
  for (size_t i = 1; i <= count; ++i) number[i] = number[i - 1] + int32_t(owns[i]);
  if (number[count] == int32_t(count)) return;
  parallelForEach(leaves.size(), kLeafGrain, interrupter, [&](size_t i) {
    for (auto voxel = leaves[i]->beginValueOn(); voxel; ++voxel)
      voxel.setValue(number[size_t(*voxel)]);
  });
}

}  // namespace vdb_madf::detail
