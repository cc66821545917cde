// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/edits/detail/grain_parts.h"

#include <algorithm>
#include <iterator>
#include <limits>
#include <map>
#include <string>
#include <utility>

#include "vdb_madf/base/detail/parallel.h"
#include "vdb_madf/base/detail/sorted.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/edits/detail/last_join.h"
#include "vdb_madf/edits/detail/weakest_neck.h"
#include "vdb_madf/grids/detail/leaf_nodes.h"
#include "vdb_madf/labels/detail/label_blocks.h"
#include "vdb_madf/leaves/detail/leaf_mask.h"
#include "vdb_madf/method/detail/refill.h"
#include "vdb_madf/segmentation/detail/manifold_labels.h"
#include "vdb_madf/segmentation/graph_metadata.h"
#include "vdb_madf/segmentation/segmentation_metadata.h"

namespace vdb_madf::detail {

namespace {

using Leaf = Int32Tree::LeafNodeType;
using Mask = LeafIndex::Mask;
using LeafVoxels = LeafIndex::LeafVoxels;
constexpr uint32_t kForeign = 0xffffffffu;  // a voxel's manifold is none of the part's

int64_t count(const std::vector<LeafVoxels>& voxels) {
  int64_t sum = 0;
  for (const LeafVoxels& leaf : voxels) sum += countVoxels(leaf.mask);
  return sum;
}

/// Voxels that two sets have in common.
int64_t countCommon(const std::vector<LeafVoxels>& few, const std::vector<LeafVoxels>& many) {
  int64_t sum = 0;
  auto other = many.begin();
  for (const LeafVoxels& leaf : few) {
    other = std::lower_bound(other, many.end(), leaf.origin, ByOrigin());
    if (other == many.end()) break;
    if (other->origin == leaf.origin) sum += countVoxels(both(leaf.mask, other->mask));
  }
  return sum;
}

/// The voxels of a grain of some labels, ascending by origin.
std::vector<LeafVoxels> voxelsWith(const Int32Grid& labels, int32_t grain,
                                   Interrupter* interrupter) {
  const Int32Tree::ConstPtr tree = withoutTiles(labels);
  const auto leaves = leavesOf(*tree);
  std::vector<Mask> masks(leaves.size());
  parallelForEach(leaves.size(), kLeafGrain, interrupter, [&](size_t n) {
    masks[n] = Mask{};
    for (auto voxel = leaves[n]->cbeginValueOn(); voxel; ++voxel)
      if (*voxel == grain) masks[n][voxel.pos() >> 6] |= uint64_t(1) << (voxel.pos() & 63);
  });
  std::vector<LeafVoxels> voxels;
  for (size_t n = 0; n < leaves.size(); ++n)
    if (anyVoxel(masks[n])) voxels.push_back({leaves[n]->origin(), masks[n]});
  std::sort(voxels.begin(), voxels.end(), ByOrigin());
  return voxels;
}

/// The node of largest D, of several the first.
uint32_t representative(const ManifoldGraph& graph, const std::vector<uint32_t>& nodes) {
  return *std::max_element(nodes.begin(), nodes.end(), [&](uint32_t a, uint32_t b) {
    return graph.nodes[a].squaredRadius < graph.nodes[b].squaredRadius;
  });
}

/// Gives voxels without a label that of most voxels around (refill.h); 1 where no round reaches.
void fill(const LeafIndex& index, VoxelArray<uint32_t>& labels, Interrupter* interrupter) {
  std::vector<VoxelId> open;
  forEachVoxel(index, 0, index.leafCount(), [&](VoxelId id, size_t rank) {
    if (labels[rank] == 0) open.push_back(id);
  });
  const auto around = [&](uint32_t i) { return labelsAround(index, labels, open[i]); };
  const auto give = [&](uint32_t i, uint32_t label) { labels[index.rank(open[i])] = label; };
  const NumberedVoxels numbers(index, open);
  const auto beside = [&](uint32_t i, const auto& f) { numbers.forEachBeside(open[i], f); };
  for (const uint32_t i : refill(open.size(), around, give, beside, interrupter)) give(i, 1);
}

/// The voxels of an index with a label.
std::vector<LeafVoxels> labelled(const LeafIndex& index, const VoxelArray<uint32_t>& labels,
                                 uint32_t label) {
  std::vector<LeafVoxels> voxels;
  for (size_t leaf = 0; leaf < index.leafCount(); ++leaf) {
    Mask mask{};
    forEachVoxel(index, leaf, leaf + 1, [&](VoxelId id, size_t rank) {
      if (labels[rank] == label) mask[wordOf(id)] |= uint64_t(1) << bitOf(id);
    });
    if (anyVoxel(mask)) voxels.push_back({index.origin(leaf), mask});
  }
  return voxels;
}

[[noreturn]] void failNotParts(int32_t grain) {
  throw InvalidInput("grain " + std::to_string(grain) +
                     " is not made of manifolds: something else than merging, dropping and "
                     "splitting has changed it");
}

}  // namespace

GrainParts::GrainParts(const Int32Grid& manifold, const Int32Grid& labels, Interrupter* interrupter)
    : manifold_(manifold), graph_(requiredGraph(manifold)) {
  const auto merging = storedMerging(labels);
  if (!merging)
    throw InvalidInput(
        "the labels do not say by which options manifolds were merged: take those of a "
        "segmentation");
  merging_ = merge(graph_, merging->options);
  if (merging->options.mode == MergeMode::score)
    hierarchy_ = mergeHierarchy(graph_, merging->options.strictness);
  tidyRounds_ = merging->tidy;
  const auto largest = int64_t(merging_.representative.size() + graph_.nodes.size());
  if (largest > std::numeric_limits<int32_t>::max())
    throw InvalidInput("there are too many manifolds to number their parts");
  largestNumber_ = int32_t(largest);
  index_ = topologyOf(manifold);
  grains_ = labelGrains(manifold, index_, graph_, merging_, interrupter);
  tidy(index_, tidyRounds_, grains_, interrupter);
}

std::vector<GrainPart> GrainParts::divide(const Int32Grid& labels, int32_t grain,
                                          Interrupter* interrupter) const {
  const std::vector<LeafVoxels> wanted = voxelsWith(labels, grain, interrupter);
  std::map<int32_t, std::vector<LeafVoxels>> byGrain;  // of the segmentation
  for (const LeafVoxels& leaf : wanted) {
    const auto known = index_.findLeaf(leaf.origin);
    if (!known || anyVoxel(without(leaf.mask, index_.mask(*known)))) failNotParts(grain);
    uint32_t last = 0;  // neighbors mostly share their grain
    Mask* mask = nullptr;
    forEachVoxel(index_, *known, *known + 1, [&](VoxelId id, size_t rank) {
      if (!holds(leaf.mask, offsetOf(id))) return;
      if (!mask || grains_.label[rank] != last) {
        last = grains_.label[rank];
        std::vector<LeafVoxels>& voxels = byGrain[int32_t(last)];
        if (voxels.empty() || voxels.back().origin != leaf.origin)
          voxels.push_back({leaf.origin, Mask{}});
        mask = &voxels.back().mask;
      }
      (*mask)[wordOf(id)] |= uint64_t(1) << bitOf(id);
    });
  }
  std::vector<GrainPart> parts;
  for (auto& [own, voxels] : byGrain) {
    if (own == 0) failNotParts(grain);
    if (count(voxels) == grains_.voxels[size_t(own - 1)])
      parts.push_back(wholeGrain(own, std::move(voxels)));
    else if (!addParts(wholeGrain(own, voxelsOf(own, interrupter)), voxels, parts, interrupter))
      failNotParts(grain);
  }
  if (parts.size() == 1) {
    GrainPart& part = parts.front();
    if (part.nodes.empty()) part.nodes = nodesOf(part.grain);
    auto two = halves(part, interrupter);
    if (!two)
      throw InvalidInput("grain " + std::to_string(grain) +
                         " is a single manifold: it cannot be split");
    parts.assign(std::make_move_iterator(two->begin()), std::make_move_iterator(two->end()));
  }
  std::sort(parts.begin(), parts.end(),
            [](const GrainPart& a, const GrainPart& b) { return a.number < b.number; });
  return parts;
}

std::vector<LeafVoxels> GrainParts::voxelsOf(int32_t grain, Interrupter* interrupter) const {
  std::vector<Mask> masks(index_.leafCount());
  parallelForEach(masks.size(), kLeafGrain, interrupter, [&](size_t leaf) {
    masks[leaf] = Mask{};
    forEachVoxel(index_, leaf, leaf + 1, [&](VoxelId id, size_t rank) {
      if (int32_t(grains_.label[rank]) == grain)
        masks[leaf][wordOf(id)] |= uint64_t(1) << bitOf(id);
    });
  });
  std::vector<LeafVoxels> voxels;
  for (size_t leaf = 0; leaf < masks.size(); ++leaf)
    if (anyVoxel(masks[leaf])) voxels.push_back({index_.origin(leaf), masks[leaf]});
  return voxels;
}

GrainPart GrainParts::wholeGrain(int32_t grain, std::vector<LeafVoxels> voxels) {
  GrainPart part;
  part.number = part.grain = grain;
  part.voxelCount = count(voxels);
  part.voxels = std::move(voxels);
  return part;
}

std::vector<uint32_t> GrainParts::nodesOf(int32_t grain) const {
  std::vector<uint32_t> nodes;
  for (uint32_t node = 0; node < merging_.grainOfNode.size(); ++node)
    if (merging_.grainOfNode[node] == grain) nodes.push_back(node);
  return nodes;
}

/// By hand rather than by recursion: a chain of manifolds is as deep as it is long.
bool GrainParts::addParts(GrainPart whole, const std::vector<LeafVoxels>& wanted,
                          std::vector<GrainPart>& parts, Interrupter* interrupter) const {
  whole.nodes = nodesOf(whole.grain);
  std::vector<GrainPart> open;
  open.push_back(std::move(whole));
  while (!open.empty()) {
    const GrainPart part = std::move(open.back());
    open.pop_back();
    const int64_t common = countCommon(part.voxels, wanted);
    if (common == 0) continue;
    if (common == part.voxelCount) {
      parts.push_back(part);
      continue;
    }
    auto two = halves(part, interrupter);
    if (!two) return false;
    open.push_back(std::move((*two)[0]));
    open.push_back(std::move((*two)[1]));
  }
  return true;
}

std::optional<std::array<GrainPart, 2>> GrainParts::halves(const GrainPart& part,
                                                           Interrupter* interrupter) const {
  const LeafIndex index(part.voxels);
  const VoxelArray<uint32_t> places = placesIn(part, index, interrupter);
  std::vector<int64_t> voxels(part.nodes.size(), 0);
  for (size_t rank = 0; rank < places.size(); ++rank)
    if (places[rank] != kForeign) ++voxels[places[rank]];
  std::optional<std::vector<char>> beyond;
  if (hierarchy_) beyond = beyondLastJoin(graph_, *hierarchy_, part.nodes, voxels);
  if (!beyond) beyond = beyondWeakestNeck(graph_, part.nodes, voxels);
  if (!beyond) return std::nullopt;

  std::array<GrainPart, 2> two;
  GrainLabels grains;
  grains.weights = graph_.weights;
  grains.label = VoxelArray<uint32_t>(places.size());
  for (size_t rank = 0; rank < places.size(); ++rank)
    grains.label[rank] = places[rank] == kForeign ? 0 : 1 + uint32_t((*beyond)[places[rank]]);
  fill(index, grains.label, interrupter);
  grains.voxels = {0, 0};
  for (size_t rank = 0; rank < places.size(); ++rank) ++grains.voxels[grains.label[rank] - 1];
  for (size_t place = 0; place < part.nodes.size(); ++place)
    two[size_t((*beyond)[place])].nodes.push_back(part.nodes[place]);
  for (const GrainPart& half : two)
    grains.representative.push_back(graph_.nodes[representative(graph_, half.nodes)].position);
  tidy(index, tidyRounds_, grains, interrupter);
  for (uint32_t side = 0; side < 2; ++side) {
    two[side].grain = part.grain;
    two[side].number = numberOf(part.grain, two[side].nodes);
    two[side].voxels = labelled(index, grains.label, side + 1);
    two[side].voxelCount = count(two[side].voxels);
  }
  return two;
}

/// The place of each voxel's manifold in the part's list; kForeign: it is not there.
VoxelArray<uint32_t> GrainParts::placesIn(const GrainPart& part, const LeafIndex& index,
                                          Interrupter* interrupter) const {
  VoxelArray<uint32_t> places(size_t(index.voxelCount()));
  parallelFor(index.leafCount(), kLeafGrain, interrupter, [&](size_t begin, size_t end) {
    const auto tree = manifold_.getConstUnsafeAccessor();
    int32_t last = 0;  // neighbors mostly share their manifold
    uint32_t place = kForeign;
    for (size_t leaf = begin; leaf < end; ++leaf) {
      const Leaf* node = tree.probeConstLeaf(index.origin(leaf));
      const int32_t tile = node ? 0 : tree.getValue(index.origin(leaf));
      forEachVoxel(index, leaf, leaf + 1, [&](VoxelId id, size_t rank) {
        const int32_t number = node ? node->getValue(offsetOf(id)) : tile;
        if (number != last) {
          last = number;
          place = uint32_t(findSorted(part.nodes, uint32_t(number - 1)).value_or(kForeign));
        }
        places[rank] = place;
      });
    }
  });
  return places;
}

int32_t GrainParts::numberOf(int32_t grain, const std::vector<uint32_t>& nodes) const {
  const uint32_t node = representative(graph_, nodes);
  if (node == merging_.representative[size_t(grain - 1)]) return grain;
  return int32_t(merging_.representative.size() + node + 1);
}

}  // namespace vdb_madf::detail
