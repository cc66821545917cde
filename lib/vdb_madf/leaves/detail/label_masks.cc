// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/leaves/detail/label_masks.h"

#include <algorithm>

#include "vdb_madf/base/detail/parallel.h"
#include "vdb_madf/leaves/detail/leaf_mask.h"
#include "vdb_madf/leaves/detail/leaf_values.h"

namespace vdb_madf::detail {

namespace {

using Entry = LabelMasks::Entry;

bool hasLessLabel(const Entry& a, const Entry& b) {
  return a.label < b.label;
}

/// The entries of a leaf; `values`: of its voxels.
void addEntries(const LeafIndex::Mask& mask, size_t count, const uint32_t* values,
                std::vector<Entry>& entries) {
  if (allEqual(values, count)) {
    if (values[0] != 0) entries.push_back({mask, values[0]});
    return;
  }
  uint32_t dense[512];
  expandLeaf(mask, values, dense);
  const size_t before = entries.size();
  forEachValue(mask, dense, [&](uint32_t label, const LeafIndex::Mask& voxels) {
    if (label != 0) entries.push_back({voxels, label});
  });
  std::sort(entries.begin() + std::ptrdiff_t(before), entries.end(), hasLessLabel);
}

}  // namespace

LabelMasks::LabelMasks(const LeafIndex& index, const VoxelArray<uint32_t>& labels,
                       Interrupter* interrupter)
    : chunks_((index.leafCount() + kChunk - 1) / kChunk), lists_(index.leafCount()) {
  parallelForEach(chunks_.size(), 1, interrupter, [&](size_t i) {
    const size_t stop = std::min(index.leafCount(), (i + 1) * kChunk);
    for (size_t leaf = i * kChunk; leaf < stop; ++leaf) {
      const uint32_t first = uint32_t(chunks_[i].size());
      addEntries(index.mask(leaf), index.leafVoxels(leaf), labels.data() + index.firstRank(leaf),
                 chunks_[i]);
      const uint32_t count = uint32_t(chunks_[i].size()) - first;
      lists_[leaf] = {first, count, count};
    }
  });
}

void LabelMasks::give(size_t leaf, uint32_t label, const LeafIndex::Mask& voxels) {
  std::vector<Entry>& chunk = chunks_[leaf / kChunk];
  List& list = lists_[leaf];
  for (size_t i = list.first; i < list.first + list.count; ++i)
    chunk[i].mask = without(chunk[i].mask, voxels);
  const Entry* const place =
      std::lower_bound(begin(leaf), end(leaf), Entry{{}, label}, hasLessLabel);
  const size_t at = size_t(place - begin(leaf));
  if (place == end(leaf) || place->label != label) {
    if (list.count == list.capacity) {  // to the end of the chunk
      const std::vector<Entry> moved(begin(leaf), end(leaf));
      list.first = uint32_t(chunk.size());
      list.capacity = 2 * list.count + 2;
      chunk.insert(chunk.end(), moved.begin(), moved.end());
      chunk.resize(list.first + list.capacity);
    }
    Entry* const first = chunk.data() + list.first;
    std::move_backward(first + at, first + list.count, first + list.count + 1);
    first[at] = {{}, label};
    ++list.count;
  }
  LeafIndex::Mask& mask = chunk[list.first + at].mask;
  for (size_t x = 0; x < 8; ++x) mask[x] |= voxels[x];
}

}  // namespace vdb_madf::detail
