// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/slabs/deal_slabs.h"

#include <algorithm>
#include <string>
#include <vector>

#include "vdb_madf/base/errors.h"
#include "vdb_madf/slabs/store/slab_store.h"

namespace vdb_madf {

namespace {

using Leaves = std::vector<LeafIndex::LeafVoxels>;

std::string layerName(int z) {
  return "layer-" + std::to_string(z);
}

/// Does a layer or slab lie within reach of the slabs of a member? Not if it has none.
bool isWanted(const Team& team, int member, const std::vector<int>& cuts, int64_t reach, int begin,
              int end) {
  const size_t slabs = cuts.size() - 1, first = team.firstSlab(member, slabs),
               last = team.firstSlab(member + 1, slabs);
  return first < last && end + reach > cuts[first] && begin - reach < cuts[last];
}

}  // namespace

/// What each layer takes, of all members.
struct SlabDealer::Layers {
  int first = 0;  ///< z of the lowest
  std::vector<int64_t> bytes;
  int64_t whole = 0;  ///< bytes that the whole takes, all the time

  std::vector<int> chooseCuts(const SlabLimits& limits, int members) const;
};

void SlabDealer::add(const MaskTree& layer) {
  Leaves leaves;
  const LeafCosts costs = addLeaves(layer, costs_, leaves);
  if (leaves.empty()) return;
  const int z = leaves[0].origin.z();
  for (const LeafIndex::LeafVoxels& leaf : leaves)
    if (leaf.origin.z() != z) throw InvalidInput("a layer of leaf nodes has several heights");
  if (!read_.emplace(z, costs).second) throw InvalidInput("a layer of leaf nodes comes twice");
  detail::writeLeaves(scratch_, layerName(z), leaves);
}

void SlabDealer::finish(const SlabLimits& limits, int64_t reach,
                        const std::optional<Domain>& domain) {
  const Layers layers = countLayers(domain);
  const std::vector<int> cuts = layers.chooseCuts(limits, team_.count());
  if (scratch_.isShared()) reach = 0;  // what lies beyond its slabs a member reads where it is
  send(cuts, reach);
  team_.exchange(scratch_);
  receive(cuts, reach, layers);
  team_.exchange(scratch_);
  if (!scratch_.isShared() || team_.member() == 0) writeCuts(scratch_, cuts);
  team_.exchange(scratch_);
}

SlabDealer::Layers SlabDealer::countLayers(const std::optional<Domain>& domain) const {
  constexpr int64_t kNothing = INT32_MIN;
  std::vector<int64_t> ends{kNothing, kNothing};
  const auto include = [&](int first, int last) {
    ends = {std::max<int64_t>(ends[0], -int64_t(first)), std::max<int64_t>(ends[1], last)};
  };
  if (!read_.empty()) include(read_.begin()->first, read_.rbegin()->first);
  if (domain && !domain->box().empty()) include(domain->box().min().z(), domain->box().max().z());
  team_.max(ends);
  if (ends[0] == kNothing) return {0, {0}, 0};
  Layers layers;
  layers.first = int(-ends[0]) & ~7;
  layers.bytes.assign(size_t((ends[1] - layers.first) / 8 + 1), 0);
  for (const auto& [z, costs] : read_) {
    layers.bytes[size_t(z - layers.first) / 8] = costs.ofSlab;
    layers.whole += costs.ofWhole;
  }
  layers.bytes.push_back(layers.whole);
  team_.sum(layers.bytes);
  layers.whole = layers.bytes.back();
  layers.bytes.pop_back();
  return layers;
}

std::vector<int> SlabDealer::Layers::chooseCuts(const SlabLimits& limits, int members) const {
  int64_t total = 0;
  for (const int64_t ofLayer : bytes) total += ofLayer;
  // A slab has one layer at least, however little the whole leaves it.
  const int64_t allowed = limits.bytes > 0 ? std::max<int64_t>(limits.bytes - whole, 1) : INT64_MAX;
  const int64_t most = std::min(total / members + 1, allowed);
  std::vector<int> cuts{first};
  int64_t inSlab = 0;
  for (size_t layer = 0; layer < bytes.size(); ++layer) {
    const int z = first + int(layer) * 8, height = z - cuts.back();
    // A cut where the slab's share is nearer than after this layer; a limit is not passed.
    const bool isFull =
        inSlab > 0 && (inSlab + bytes[layer] / 2 >= most || inSlab + bytes[layer] > allowed);
    const bool isHigh = limits.height > 0 && height + 8 > (limits.height + 7) / 8 * 8;
    if (height >= std::max(limits.leastHeight, 8) && (isFull || isHigh)) {
      cuts.push_back(z);
      inSlab = 0;
    }
    inSlab += bytes[layer];
  }
  cuts.push_back(first + int(bytes.size()) * 8);
  return cuts;
}

/// The layers that others want. (Those of a scratch that is shared are there.)
void SlabDealer::send(const std::vector<int>& cuts, int64_t reach) {
  if (scratch_.isShared()) return;
  for (const auto& layer : read_) {
    const int z = layer.first;
    const Bytes bytes = scratch_.read(layerName(z));
    for (int member = 0; member < team_.count(); ++member)
      if (member != team_.member() && isWanted(team_, member, cuts, reach, z, z + 8))
        team_.send(member, layerName(z), bytes, scratch_);
    if (!isWanted(team_, team_.member(), cuts, reach, z, z + 8)) scratch_.remove(layerName(z));
  }
}

/// Makes slabs of layers.
void SlabDealer::receive(const std::vector<int>& cuts, int64_t reach, const Layers& layers) {
  const auto isWantedHere = [&](int begin, int end) {
    return isWanted(team_, team_.member(), cuts, reach, begin, end);
  };
  for (size_t s = 0; s + 1 < cuts.size(); ++s) {
    if (!isWantedHere(cuts[s], cuts[s + 1])) continue;
    Leaves slab;
    std::vector<std::string> done;
    for (int z = cuts[s]; z < cuts[s + 1]; z += 8) {
      if (layers.bytes[size_t(z - layers.first) / 8] == 0 || !isWantedHere(z, z + 8)) continue;
      done.push_back(layerName(z));
      const Leaves layer = detail::readLeaves(scratch_, done.back());
      slab.insert(slab.end(), layer.begin(), layer.end());
    }
    std::sort(slab.begin(), slab.end(), ByOrigin());
    detail::writeLeaves(scratch_, detail::kObject.of(s), slab);
    for (const std::string& name : done) scratch_.remove(name);
  }
}

}  // namespace vdb_madf
