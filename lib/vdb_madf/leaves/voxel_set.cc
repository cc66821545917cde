// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/leaves/voxel_set.h"

namespace vdb_madf {

void VoxelSet::rankMembers() {
  before_.resize(words_.size());
  uint32_t count = 0;
  for (size_t i = 0; i < words_.size(); ++i) {
    before_[i] = count;
    count += detail::countBits(words_[i]);
  }
  size_ = count;
}

std::vector<VoxelId> VoxelSet::members() const {
  std::vector<VoxelId> ids;
  ids.reserve(size_);
  for (size_t i = 0; i < words_.size(); ++i)
    detail::forEachBit(words_[i], [&](int bit) { ids.push_back(VoxelId(i * 64 + bit)); });
  return ids;
}

}  // namespace vdb_madf
