// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/slabs/cuts/slab_body.h"

#include <algorithm>
#include <utility>

#include "vdb_madf/method/cavities.h"
#include "vdb_madf/method/detail/small_holes.h"

namespace vdb_madf::detail {

namespace {

/// Both are ascending by origin.
std::vector<LeafIndex::LeafVoxels> joined(std::vector<LeafIndex::LeafVoxels> object,
                                          const std::vector<LeafIndex::LeafVoxels>& holes) {
  std::vector<LeafIndex::LeafVoxels> more;
  auto leaf = object.begin();
  for (const LeafIndex::LeafVoxels& hole : holes) {
    leaf = std::lower_bound(leaf, object.end(), hole.origin, ByOrigin());
    if (leaf == object.end() || leaf->origin != hole.origin)
      more.push_back(hole);
    else
      for (size_t x = 0; x < 8; ++x) leaf->mask[x] |= hole.mask[x];
  }
  if (more.empty()) return object;
  std::vector<LeafIndex::LeafVoxels> all(object.size() + more.size());
  std::merge(object.begin(), object.end(), more.begin(), more.end(), all.begin(), ByOrigin());
  return all;
}

}  // namespace

SlabBody::SlabBody(std::vector<LeafIndex::LeafVoxels> object,
                   const std::vector<LeafIndex::LeafVoxels>& holes)
    : index(joined(std::move(object), holes)) {
  Cavities filled;
  filled.leaves = holes;
  cavities = cavityVoxels(index, filled);
}

std::vector<LeafIndex::LeafVoxels> slabHoles(const SlabObject& object, std::optional<Domain> domain,
                                             size_t slab, bool open, int64_t fillHoles,
                                             Interrupter* interrupter) {
  const std::vector<int>& cuts = object.cuts;
  const int64_t reach = std::min<int64_t>(fillHoles, int64_t(cuts.back()) - cuts.front());
  const auto inWindow = [&](int64_t begin, int64_t end) {
    return end + reach > cuts[slab] && begin - reach < cuts[slab + 1];
  };
  std::vector<LeafIndex::LeafVoxels> window;
  for (size_t s = 0; s < object.slabCount(); ++s) {
    if (!inWindow(cuts[s], cuts[s + 1])) continue;
    for (const LeafIndex::LeafVoxels& leaf : object.leaves(s))
      if (inWindow(leaf.origin.z(), leaf.origin.z() + 8)) window.push_back(leaf);
  }
  const bool isRegion = domain && !domain->isBox();
  if (window.empty() && !(isRegion && open)) return {};  // an open region has small pieces anywhere
  std::sort(window.begin(), window.end(), ByOrigin());
  if (domain) {
    // Of leaves: as far as `window` knows the object.
    CoordBBox box = domain->box();
    int first = cuts[slab], last = cuts[slab + 1];
    while (first > box.min().z() && inWindow(first - 8, first)) first -= 8;
    while (last <= box.max().z() && inWindow(last, last + 8)) last += 8;
    box.min().z() = std::max(box.min().z(), first);
    box.max().z() = std::min(box.max().z(), last - 1);
    if (isRegion) {
      MaskTree part(*domain->region());
      part.clip(box);
      if (part.empty()) return {};
      domain = Domain(part);
    } else {
      domain = box;
    }
  }
  const Cavities found = smallHoles(LeafIndex(window), domain, open, fillHoles, interrupter);
  std::vector<LeafIndex::LeafVoxels> holes;
  for (const LeafIndex::LeafVoxels& leaf : found.leaves)
    if (leaf.origin.z() >= cuts[slab] && leaf.origin.z() < cuts[slab + 1]) holes.push_back(leaf);
  return holes;
}

void HoleCount::add(const std::vector<LeafIndex::LeafVoxels>& holes, int begin, int end) {
  const LeafIndex index(holes);
  const ConnectedComponents components(index);
  pieces_.add(components.count(),
              pieceJoins(highest_, facePieces(index, components, {begin, end, false})));
  highest_ = facePieces(index, components, {begin, end, true});
  voxels_ += index.voxelCount();
  boundingBox_.expand(index.boundingBox());
}

}  // namespace vdb_madf::detail
