// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/slabs/slab_builder.h"

#include <algorithm>
#include <utility>

#include "vdb_madf/base/errors.h"
#include "vdb_madf/grids/detail/active_tiles.h"
#include "vdb_madf/leaves/detail/leaf_mask.h"
#include "vdb_madf/slabs/store/slab_store.h"

namespace vdb_madf {

namespace {

constexpr char kCuts[] = "cuts";

}  // namespace

SlabCosts::SlabCosts(const SegmentOptions& options)
    : leaf(2400), voxel(4), speck(options.merge.mode == MergeMode::score ? 200 : 90) {
  if (options.gamma > 1) voxel += 2;
  if (options.keepManifold) leaf += 2700;
}

LeafCosts addLeaves(const MaskTree& layer, const SlabCosts& costs,
                    std::vector<LeafIndex::LeafVoxels>& leaves) {
  LeafCosts added;
  for (auto leaf = layer.cbeginLeaf(); leaf; ++leaf) {
    if (leaf->isEmpty()) continue;
    leaves.push_back({leaf->origin(), detail::maskOf(*leaf)});
    const LeafIndex::Mask& mask = leaves.back().mask;
    const int64_t thin = detail::countThin(mask);
    added.ofSlab += costs.of(1, detail::countVoxels(mask), thin);
    if (thin > 0) added.ofWhole += costs.speck * detail::countSpecks(mask);
  }
  detail::forEachActiveTile(layer, [](const CoordBBox&) {
    throw InvalidInput("a layer of leaf nodes has an active tile: voxelize it");
  });
  return added;
}

void SlabBuilder::add(const MaskTree& layer) {
  const size_t before = leaves_.size();
  const LeafCosts added = addLeaves(layer, costs_, leaves_);
  if (leaves_.size() == before) return;
  const int z = leaves_[before].origin.z();
  for (size_t i = before; i < leaves_.size(); ++i)
    if (leaves_[i].origin.z() != z) throw InvalidInput("a layer of leaf nodes has several heights");
  if (lastLayer_ && z <= *lastLayer_)
    throw InvalidInput("layers of leaf nodes have to come in the order of z");
  lastLayer_ = z;
  if (cuts_.empty()) cuts_.push_back(z);
  const int height = z - cuts_.back();
  const bool isHigh = limits_.height > 0 && height + 8 > (limits_.height + 7) / 8 * 8;
  // What the whole will take is not known yet, but for what has been seen of it.
  const int64_t whole = std::max(wholeBytes_, std::min(16 * wholeBytes_, limits_.bytes / 4));
  const bool isFull = limits_.bytes > 0 && bytes_ + whole + added.ofSlab > limits_.bytes;
  if (height >= std::max(limits_.leastHeight, 8) && (isHigh || isFull)) {
    std::vector<LeafIndex::LeafVoxels> next(leaves_.begin() + std::ptrdiff_t(before),
                                            leaves_.end());
    leaves_.resize(before);
    endSlab(z);
    leaves_ = std::move(next);
  }
  bytes_ += added.ofSlab;
  wholeBytes_ += added.ofWhole;
}

void SlabBuilder::endSlab(int z) {
  std::sort(leaves_.begin(), leaves_.end(), ByOrigin());
  detail::writeLeaves(scratch_, detail::kObject.of(cuts_.size() - 1), leaves_);
  leaves_.clear();
  largestSlabBytes_ = std::max(largestSlabBytes_, bytes_);
  bytes_ = 0;
  cuts_.push_back(z);
}

void SlabBuilder::finish(const std::optional<Domain>& domain) {
  int top = lastLayer_ ? *lastLayer_ + 8 : 8;
  if (domain && !domain->box().empty()) top = std::max(top, (domain->box().max().z() | 7) + 1);
  if (cuts_.empty()) cuts_.push_back(domain ? domain->box().min().z() & ~7 : 0);
  endSlab(std::max(top, cuts_.back() + 8));
  if (domain) cuts_[0] = std::min(cuts_[0], domain->box().min().z() & ~7);
  writeCuts(scratch_, cuts_);
}

void writeCuts(Scratch& scratch, const std::vector<int>& cuts) {
  detail::ByteWriter bytes;
  bytes.add(cuts);
  scratch.write(kCuts, bytes.bytes());
}

bool hasSlabs(const Scratch& scratch) {
  return scratch.has(kCuts);
}

SlabObject storedSlabs(const Scratch& scratch, MaskGrid::ConstPtr about) {
  SlabObject object;
  object.about = std::move(about);
  object.cuts = detail::ByteReader(scratch.read(kCuts)).vector<int>();
  object.leaves = [&scratch](size_t slab) { return detail::storedObject(scratch, slab); };
  return object;
}

}  // namespace vdb_madf
