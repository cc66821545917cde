// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/detail/label_leaves.h"

#include <algorithm>
#include <cstring>

#include "vdb_madf/detail/parallel.h"
#include "vdb_madf/detail/voxels.h"
#include "vdb_madf/object_mask.h"

namespace vdb_madf::detail {

namespace {

/// Up to this many labels a search beats a hash table.
constexpr size_t kFewLabels = 24;

// Bits y*8 + z of a word of a mask.
constexpr uint64_t kFirstY = 0xffull, kLastY = kFirstY << 56;

bool isFull(const LeafIndex::Mask& mask) {
  return std::all_of(mask.begin(), mask.end(), [](uint64_t word) { return word == ~0ull; });
}

/// Four bits as four lanes of 0 or 1.
std::array<uint64_t, 16> makeLanes() {
  std::array<uint64_t, 16> lanes{};
  for (unsigned bits = 0; bits < 16; ++bits) {
    uint16_t lane[4];
    for (unsigned i = 0; i < 4; ++i) lane[i] = bits >> i & 1;
    std::memcpy(&lanes[bits], lane, sizeof lane);
  }
  return lanes;
}
const std::array<uint64_t, 16> kLanesOf = makeLanes();

/// The label that all masked voxels have, 0 if they differ.
int32_t singleLabel(const int32_t* values, const LeafIndex::Mask& mask) {
  int32_t label = 0;
  for (size_t x = 0; x < 8; ++x) {
    for (uint64_t word = mask[x]; word; word &= word - 1) {
      const int32_t value = values[x * 64 + size_t(__builtin_ctzll(word))];
      if (!label) label = value;
      if (value != label) return 0;
    }
  }
  return label;
}

}  // namespace

LabelLeaves::LabelLeaves(const Int32Grid& labels, Interrupter* interrupter)
    : index_(*objectMask(labels)), values_(index_.leafCount()), singles_(index_.leafCount()) {
  parallelFor(index_.leafCount(), kLeafGrain, interrupter, [&](size_t begin, size_t end) {
    const Int32Grid::ConstAccessor accessor = labels.getConstAccessor();
    for (size_t leaf = begin; leaf < end; ++leaf) {
      if (const auto* node = accessor.probeConstLeaf(index_.origin(leaf))) {
        values_[leaf] = node->buffer().data();
        singles_[leaf] = singleLabel(values_[leaf], index_.mask(leaf));
      } else {
        singles_[leaf] = accessor.getValue(index_.origin(leaf));
      }
    }
  });
}

LeafIndex::Mask LabelLeaves::maskOf(size_t leaf, int32_t label) const {
  LeafIndex::Mask mask{};
  if (singles_[leaf]) return singles_[leaf] == label ? index_.mask(leaf) : mask;
  for (size_t x = 0; x < 8; ++x) {
    for (size_t i = 0; i < 64; ++i) mask[x] |= uint64_t(values_[leaf][x * 64 + i] == label) << i;
    mask[x] &= index_.mask(leaf)[x];
  }
  return mask;
}

bool LabelLeaves::isInterior(size_t leaf) const {
  if (!singles_[leaf] || !isFull(index_.mask(leaf))) return false;
  for (const uint32_t next : index_.neighbors(leaf))
    if (next == LeafIndex::kNone || singles_[next] != singles_[leaf]) return false;
  const auto mask = [&](size_t side) -> const LeafIndex::Mask& {
    return index_.mask(index_.neighbors(leaf)[side]);
  };
  uint64_t layers = mask(0)[7] & mask(1)[0];
  for (size_t x = 0; x < 8; ++x) {
    layers &= mask(2)[x] | ~kLastY;
    layers &= mask(3)[x] | ~kFirstY;
    layers &= mask(4)[x] | ~kLastZ;
    layers &= mask(5)[x] | ~kFirstZ;
  }
  return layers == ~0ull;
}

LabelWindow::Code LabelWindow::codeOf(int32_t label) {
  if (names_.size() <= kFewLabels) {
    const auto found = std::find(names_.begin() + 1, names_.end(), label);
    if (found != names_.end()) return Code(found - names_.begin());
    names_.push_back(label);
    if (names_.size() > kFewLabels)
      for (size_t i = 1; i < names_.size(); ++i) codesByName_[names_[i]] = Code(i);
    return Code(names_.size() - 1);
  }
  const auto [entry, isNew] = codesByName_.try_emplace(label, Code(names_.size()));
  if (isNew) names_.push_back(label);
  return entry->second;
}

/// Of the three leaves of a column along z.
void LabelWindow::copyMasks(const std::array<const LeafIndex::Mask*, 3>& masks, int dx, int dy,
                            Bits& bits) {
  const int beginX = std::max(kBegin, dx * 8), endX = std::min(kEnd, dx * 8 + 8);
  const int beginY = std::max(kBegin, dy * 8), endY = std::min(kEnd, dy * 8 + 8);
  for (int x = beginX; x < endX; ++x) {
    const size_t at = size_t(x & 7);
    const uint64_t low = (*masks[0])[at], middle = (*masks[1])[at], high = (*masks[2])[at];
    for (int y = beginY; y < endY; ++y) {
      const int shift = (y & 7) * 8;
      bits[size_t((x - kBegin) * kSide + (y - kBegin))] = uint32_t(low >> shift & 0xff) |
                                                          uint32_t(middle >> shift & 0xff) << 8 |
                                                          uint32_t(high >> shift & 0xff) << 16;
    }
  }
}

void LabelWindow::copyCodes(uint32_t leaf, int dx, int dy, int dz) {
  const int beginX = std::max(kBegin, dx * 8), endX = std::min(kEnd, dx * 8 + 8);
  const int beginY = std::max(kBegin, dy * 8), endY = std::min(kEnd, dy * 8 + 8);
  const int32_t single = leaf == LeafIndex::kNone ? 0 : labels_->single(leaf);
  const Code code = single ? codeOf(single) : Code(0);
  int32_t last = 0;
  Code lastCode = 0;
  for (int x = beginX; x < endX; ++x) {
    const uint64_t word = leaf == LeafIndex::kNone ? 0 : labels_->index().mask(leaf)[size_t(x & 7)];
    for (int y = beginY; y < endY; ++y) {
      const auto bits = unsigned(word >> (y & 7) * 8 & 0xff);
      Code* out = codes_.data() + (row(x, y, dz * 8) - codes_.data());
      const uint64_t lanes[2] = {kLanesOf[bits & 15] * code, kLanesOf[bits >> 4] * code};
      std::memcpy(out, lanes, sizeof lanes);
      if (!bits) continue;
      Code& all = rowCodes_[size_t((x - kBegin) * kSide + (y - kBegin))];
      if (single) {
        all = all == 0 || all == code ? code : kMixed;
        continue;
      }
      for (unsigned rest = bits; rest; rest &= rest - 1) {
        const int z = __builtin_ctz(rest);
        const int32_t label = labels_->label(leaf, (x & 7) * 64 + (y & 7) * 8 + z);
        if (label != last) {
          last = label;
          lastCode = codeOf(label);
        }
        out[z] = lastCode;
        all = all == 0 || all == lastCode ? lastCode : kMixed;
      }
    }
  }
}

void LabelWindow::load(size_t leaf) {
  static constexpr LeafIndex::Mask kEmpty{};
  const LeafIndex& index = labels_->index();
  const auto& around = neighborhood_.around(leaf);
  const int32_t single = labels_->single(leaf);
  oneLabel_ = single != 0;
  for (const size_t side : {1, 3, 5}) {
    const uint32_t next = index.neighbors(leaf)[side];
    oneLabel_ = oneLabel_ && (next == LeafIndex::kNone || labels_->single(next) == single);
  }
  for (size_t column = 0; column < 9; ++column) {
    const int dx = int(column) / 3 - 1, dy = int(column) % 3 - 1;
    std::array<const LeafIndex::Mask*, 3> all, same;
    std::array<LeafIndex::Mask, 3> found;
    bool differ = false;
    for (size_t i = 0; i < 3; ++i) {
      const uint32_t other = around[3 * column + i];
      all[i] = same[i] = other == LeafIndex::kNone ? &kEmpty : &index.mask(other);
      if (!oneLabel_ || other == LeafIndex::kNone || labels_->single(other) == single) continue;
      found[i] = labels_->maskOf(other, single);
      same[i] = &found[i];
      differ = true;
    }
    copyMasks(all, dx, dy, labelled_);
    if (oneLabel_) copyMasks(differ ? same : all, dx, dy, same_);
  }
  names_.assign(1, 0);
  if (oneLabel_) {
    names_.push_back(single);
    return;
  }
  codesByName_.clear();
  rowCodes_.fill(0);
  for (int dx = -1; dx <= 1; ++dx)
    for (int dy = -1; dy <= 1; ++dy)
      for (int dz = -1; dz <= 1; ++dz)
        copyCodes(around[size_t((dx + 1) * 9 + (dy + 1) * 3 + dz + 1)], dx, dy, dz);
}

}  // namespace vdb_madf::detail
