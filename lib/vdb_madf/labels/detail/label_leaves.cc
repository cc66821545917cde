// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/labels/detail/label_leaves.h"

#include <algorithm>

#include "vdb_madf/base/detail/parallel.h"
#include "vdb_madf/grids/object_mask.h"
#include "vdb_madf/leaves/detail/leaf_values.h"

namespace vdb_madf::detail {

namespace {

void addParts(const int32_t* values, const LeafIndex::Mask& mask, std::vector<LabelPart>& parts) {
  forEachValue(mask, reinterpret_cast<const uint32_t*>(values),
               [&](uint32_t label, const LeafIndex::Mask& voxels) {
                 parts.push_back({int32_t(label), voxels});
               });
}

}  // namespace

LabelLeaves::LabelLeaves(const Int32Grid& labels, Interrupter* interrupter)
    : index_(*objectMask(labels)), chunks_((index_.leafCount() + kChunk - 1) / kChunk) {
  parallelFor(chunks_.size(), 1, interrupter, [&](size_t begin, size_t end) {
    const Int32Grid::ConstUnsafeAccessor accessor = labels.getConstUnsafeAccessor();
    for (size_t i = begin; i < end; ++i) {
      auto& [parts, first] = chunks_[i];
      for (size_t leaf = i * kChunk; leaf < std::min((i + 1) * kChunk, index_.leafCount());
           ++leaf) {
        if (const auto* node = accessor.probeConstLeaf(index_.origin(leaf)))
          addParts(node->buffer().data(), index_.mask(leaf), parts);
        else
          parts.push_back({accessor.getValue(index_.origin(leaf)), index_.mask(leaf)});
        first.push_back(uint32_t(parts.size()));
      }
    }
  });
}

LabelLeaves::LabelLeaves(const std::vector<const LabelLeaves*>& parts, const LeafLayers& layers) {
  struct Source {
    const LabelLeaves* from;
    size_t leaf;
    const Coord& origin() const { return from->index().origin(leaf); }
  };
  std::vector<Source> sources;
  for (const LabelLeaves* from : parts)
    for (size_t leaf = 0; leaf < from->index().leafCount(); ++leaf)
      if (layers.hold(from->index().origin(leaf))) sources.push_back({from, leaf});
  parallelSort(sources.begin(), sources.end(),
               [](const Source& a, const Source& b) { return a.origin() < b.origin(); });
  std::vector<LeafIndex::LeafVoxels> voxels;
  voxels.reserve(sources.size());
  for (const Source& source : sources)
    voxels.push_back({source.origin(), source.from->index().mask(source.leaf)});
  index_ = LeafIndex(voxels);
  chunks_.resize((sources.size() + kChunk - 1) / kChunk);
  for (size_t i = 0; i < sources.size(); ++i) {
    auto& [own, first] = chunks_[i / kChunk];
    const Parts more = sources[i].from->parts(sources[i].leaf);
    own.insert(own.end(), more.begin(), more.end());
    first.push_back(uint32_t(own.size()));
  }
}

int32_t LabelLeaves::label(size_t leaf, int offset) const {
  for (const LabelPart& part : parts(leaf))
    if (part.mask[size_t(offset) >> 6] >> (offset & 63) & 1) return part.label;
  return 0;
}

}  // namespace vdb_madf::detail
