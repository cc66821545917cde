// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/labels/grain_colors.h"

#include <algorithm>
#include <array>
#include <mutex>
#include <set>
#include <utility>

#include "vdb_madf/base/detail/parallel.h"
#include "vdb_madf/grids/object_mask.h"
#include "vdb_madf/labels/detail/label_blocks.h"
#include "vdb_madf/leaves/leaf_index.h"

namespace vdb_madf {

namespace {

using Leaf = Int32Tree::LeafNodeType;
using Pair = std::pair<int32_t, int32_t>;

constexpr size_t kLeafGrain = 64;

/// Chosen from the saturated colours of middle lightness (L* 42 to 92, chroma 28 and more), so that
/// they stay apart from white, from a dark background and from each other when shaded: the first 24
/// for the largest least distance, the others each as far as possible from all before it.
constexpr size_t kFirstChoice = 24, kPaletteSize = 64;
constexpr std::array<Rgb, kPaletteSize> kPalette{{
    {165, 105, 135}, {0, 255, 0},     {0, 90, 255},    {255, 165, 0},   {30, 210, 240},
    {0, 120, 30},    {255, 0, 240},   {255, 0, 0},     {255, 150, 255}, {195, 240, 195},
    {30, 105, 150},  {120, 135, 240}, {135, 15, 255},  {165, 135, 60},  {225, 30, 135},
    {0, 165, 135},   {180, 60, 0},    {165, 195, 60},  {255, 120, 135}, {255, 210, 255},
    {0, 180, 0},     {165, 45, 180},  {255, 225, 0},   {0, 240, 165},   {255, 180, 165},
    {165, 255, 105}, {150, 180, 240}, {255, 105, 0},   {195, 75, 255},  {60, 255, 240},
    {105, 135, 30},  {135, 90, 60},   {180, 60, 105},  {120, 90, 165},  {255, 210, 135},
    {135, 90, 225},  {255, 90, 210},  {0, 165, 255},   {30, 135, 150},  {120, 180, 120},
    {195, 150, 225}, {210, 105, 75},  {195, 90, 180},  {255, 150, 195}, {195, 195, 135},
    {60, 120, 90},   {210, 150, 45},  {255, 60, 120},  {120, 225, 0},   {75, 210, 105},
    {210, 0, 60},    {165, 225, 135}, {135, 225, 210}, {210, 120, 255}, {75, 120, 195},
    {195, 225, 0},   {195, 0, 150},   {225, 195, 60},  {105, 105, 30},  {45, 120, 255},
    {225, 240, 135}, {45, 180, 180},  {210, 0, 195},   {150, 75, 135},
}};
constexpr Rgb kUnknown{128, 128, 128};

constexpr int kX = detail::kHaloStride[0], kY = detail::kHaloStride[1], kZ = detail::kHaloStride[2];
/// To half of the 26 neighbours; the others lie opposite.
constexpr std::array<int, 13> kForward{kZ,           kY - kZ, kY, kY + kZ, kX - kY - kZ, kX - kY,
                                       kX - kY + kZ, kX - kZ, kX, kX + kZ, kX + kY - kZ, kX + kY,
                                       kX + kY + kZ};

bool isUniform(const detail::LabelHalo& halo) {
  int32_t label = 0;
  for (const int32_t value : halo) {
    if (!value || value == label) continue;
    if (label) return false;
    label = value;
  }
  return true;
}

/// f(a, b) for all different labels at 26-adjacent voxels of which one lies in the leaf; pairs
/// may come more than once.
template <typename F>
void forEachContact(const detail::LabelHalo& halo, const F& f) {
  if (isUniform(halo)) return;
  for (int x = 0; x < 8; ++x)
    for (int y = 0; y < 8; ++y)
      for (int z = 0; z < 8; ++z) {
        const auto at = int(detail::haloAt(x, y, z));
        const int32_t a = halo[size_t(at)];
        if (!a) continue;
        // All 26: a neighbour in another leaf may be the only one to see it, or not be a leaf.
        for (const int step : kForward) {
          for (const int32_t b : {halo[size_t(at + step)], halo[size_t(at - step)]})
            if (b && b != a) f(std::min(a, b), std::max(a, b));
        }
      }
}

void sortUnique(std::vector<Pair>& pairs) {
  std::sort(pairs.begin(), pairs.end());
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
}

struct Contacts {
  std::vector<int32_t> labels;  ///< ascending
  std::vector<Pair> pairs;      ///< of labels, ascending
};

Contacts findContacts(const Int32Grid& grid, Interrupter* interrupter) {
  const LeafIndex index(*objectMask(grid));
  std::set<int32_t> labels;
  std::vector<Pair> pairs;
  std::mutex mutex;
  detail::parallelFor(index.leafCount(), kLeafGrain, interrupter, [&](size_t begin, size_t end) {
    const Int32Grid::ConstAccessor accessor = grid.getConstAccessor();
    std::vector<int32_t> someLabels;
    std::vector<Pair> somePairs;
    detail::LabelHalo halo;
    for (size_t i = begin; i < end; ++i) {
      const Coord origin = index.origin(i);
      if (const Leaf* leaf = accessor.probeConstLeaf(origin)) {
        for (auto voxel = leaf->cbeginValueOn(); voxel; ++voxel)
          if (*voxel > 0 && (someLabels.empty() || someLabels.back() != *voxel))
            someLabels.push_back(*voxel);
      } else {
        someLabels.push_back(accessor.getValue(origin));
      }
      detail::readLabelHalo(grid.tree(), origin, halo);
      forEachContact(halo, [&](int32_t a, int32_t b) {
        if (somePairs.empty() || somePairs.back() != Pair(a, b)) somePairs.emplace_back(a, b);
      });
    }
    sortUnique(somePairs);
    // Sets: the order in which the parts arrive does not matter.
    const std::lock_guard<std::mutex> lock(mutex);
    labels.insert(someLabels.begin(), someLabels.end());
    pairs.insert(pairs.end(), somePairs.begin(), somePairs.end());
  });
  sortUnique(pairs);
  return {{labels.begin(), labels.end()}, std::move(pairs)};
}

using Graph = std::vector<std::vector<uint32_t>>;  ///< the neighbours of each label's index

Graph asGraph(const Contacts& contacts) {
  const auto indexOf = [&](int32_t label) {
    return uint32_t(std::lower_bound(contacts.labels.begin(), contacts.labels.end(), label) -
                    contacts.labels.begin());
  };
  Graph graph(contacts.labels.size());
  for (const auto& [a, b] : contacts.pairs) {
    const uint32_t i = indexOf(a), j = indexOf(b);
    graph[i].push_back(j);
    graph[j].push_back(i);
  }
  return graph;
}

/// The reverse of: take away, again and again, a node of least remaining degree. Each node then has
/// few neighbours before it: as many as that degree.
std::vector<uint32_t> smallestLast(const Graph& graph) {
  std::vector<size_t> degree(graph.size());
  std::set<std::pair<size_t, uint32_t>> queue;
  for (uint32_t i = 0; i < graph.size(); ++i) queue.emplace(degree[i] = graph[i].size(), i);
  std::vector<uint32_t> order;
  std::vector<bool> taken(graph.size(), false);
  while (!queue.empty()) {
    const uint32_t node = queue.begin()->second;
    queue.erase(queue.begin());
    taken[node] = true;
    order.push_back(node);
    for (const uint32_t other : graph[node]) {
      if (taken[other]) continue;
      queue.erase({degree[other], other});
      queue.emplace(--degree[other], other);
    }
  }
  std::reverse(order.begin(), order.end());
  return order;
}

/// Where the label's search of the palette begins: mixed, so that all colours come into use
/// (the multiplier is 2^32 divided by the golden ratio).
size_t preference(int32_t label) {
  return size_t((uint64_t(uint32_t(label) * 2654435769u) * kFirstChoice) >> 32);
}

/// The first colour that is not `used`, else the preferred one.
size_t pick(int32_t label, const std::array<bool, kPaletteSize>& used) {
  const size_t preferred = preference(label);
  for (size_t k = 0; k < kFirstChoice; ++k) {
    const size_t color = (preferred + k) % kFirstChoice;
    if (!used[color]) return color;
  }
  for (size_t color = kFirstChoice; color < kPaletteSize; ++color)
    if (!used[color]) return color;
  return preferred;
}

}  // namespace

Rgb GrainColors::colorOf(int32_t label) const {
  const auto found = std::lower_bound(labels.begin(), labels.end(), label);
  return found == labels.end() || *found != label ? kUnknown
                                                  : colors[size_t(found - labels.begin())];
}

GrainColors grainColors(const Int32Grid& labels, Interrupter* interrupter) {
  const Contacts contacts = findContacts(labels, interrupter);
  const Graph graph = asGraph(contacts);
  std::vector<size_t> color(graph.size(), kPaletteSize);  // none yet
  for (const uint32_t node : smallestLast(graph)) {
    std::array<bool, kPaletteSize> used{};
    for (const uint32_t other : graph[node])
      if (color[other] < kPaletteSize) used[color[other]] = true;
    color[node] = pick(contacts.labels[node], used);
  }

  GrainColors result;
  result.labels = contacts.labels;
  result.touchingPairs = int64_t(contacts.pairs.size());
  for (const size_t c : color) result.colors.push_back(kPalette[c]);
  for (uint32_t i = 0; i < graph.size(); ++i)
    for (const uint32_t j : graph[i]) result.alikePairs += i < j && color[i] == color[j];
  return result;
}

}  // namespace vdb_madf
