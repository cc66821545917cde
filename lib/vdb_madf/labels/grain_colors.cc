// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/labels/grain_colors.h"

#include <algorithm>
#include <array>
#include <iterator>
#include <limits>
#include <mutex>
#include <set>
#include <utility>

#include "vdb_madf/base/detail/parallel.h"
#include "vdb_madf/base/detail/simd.h"
#include "vdb_madf/base/detail/sorted.h"
#include "vdb_madf/grids/object_mask.h"
#include "vdb_madf/labels/detail/label_blocks.h"
#include "vdb_madf/labels/detail/rimmed_slabs.h"
#include "vdb_madf/leaves/detail/voxels.h"
#include "vdb_madf/leaves/leaf_index.h"

namespace vdb_madf {

namespace {

using Pair = std::pair<int32_t, int32_t>;

/// Calm colors of middle lightness (L* 45 to 90, chroma 18 to 62), which stay apart from white and
/// from a dark background. The first 16 have the largest least distance for normal eyes and for
/// those that lack one kind of cones (protanopia, deuteranopia, tritanopia, simulated after Machado
/// et al. 2009); the others are each as far as possible from all before it, for all these eyes.
constexpr size_t kFirstChoice = 16, kPaletteSize = 64;
constexpr std::array<Rgb, kPaletteSize> kPalette{{
    {30, 165, 150},  {180, 75, 30},   {120, 90, 180},  {255, 225, 105}, {150, 135, 105},
    {180, 195, 255}, {150, 240, 255}, {210, 135, 45},  {90, 120, 150},  {165, 240, 150},
    {150, 90, 105},  {165, 180, 105}, {210, 120, 195}, {30, 210, 150},  {120, 150, 255},
    {225, 165, 195}, {60, 135, 60},   {255, 165, 150}, {195, 225, 195}, {90, 120, 75},
    {75, 180, 255},  {90, 240, 225},  {255, 195, 120}, {225, 120, 150}, {180, 60, 135},
    {180, 150, 75},  {105, 105, 165}, {150, 195, 225}, {105, 180, 120}, {180, 135, 225},
    {150, 195, 90},  {210, 90, 90},   {30, 120, 210},  {195, 180, 60},  {150, 135, 165},
    {105, 195, 195}, {195, 135, 90},  {120, 135, 45},  {210, 195, 135}, {195, 210, 90},
    {150, 240, 180}, {135, 210, 180}, {255, 210, 225}, {105, 165, 210}, {135, 180, 165},
    {165, 120, 120}, {255, 165, 225}, {120, 150, 30},  {240, 90, 135},  {180, 90, 180},
    {240, 105, 180}, {195, 240, 135}, {165, 105, 165}, {225, 165, 240}, {30, 120, 105},
    {225, 195, 165}, {240, 165, 90},  {195, 60, 60},   {75, 120, 30},   {135, 120, 195},
    {195, 90, 135},  {240, 135, 120}, {255, 180, 180}, {195, 60, 105},
}};
constexpr Rgb kUnknown{128, 128, 128};

constexpr int kX = detail::kHaloStride[0], kY = detail::kHaloStride[1], kZ = detail::kHaloStride[2];
/// To half of the 26 neighbors; the others lie opposite.
constexpr std::array<int, 13> kForward{kZ,           kY - kZ, kY, kY + kZ, kX - kY - kZ, kX - kY,
                                       kX - kY + kZ, kX - kZ, kX, kX + kZ, kX + kY - kZ, kX + kY,
                                       kX + kY + kZ};

constexpr int32_t kNoLabel = std::numeric_limits<int32_t>::max();

// std::max() and std::min(), which take references, keep loops from becoming SIMD.
inline int32_t larger(int32_t a, int32_t b) {
  return a > b ? a : b;
}
inline int32_t smaller(int32_t a, int32_t b) {
  return a < b ? a : b;
}

/// The largest and the smallest label (0 and kNoLabel: there is none) of a halo and, in `largest`
/// and `smallest`, of what lies within one voxel of each voxel of the leaf; of others nothing is
/// known.
VDB_MADF_KERNEL std::pair<int32_t, int32_t> extremesOf(const int32_t* halo, int32_t* largest,
                                                       int32_t* smallest) {
  constexpr size_t kSize = std::tuple_size_v<detail::LabelHalo>;
  int32_t high[kSize], low[kSize], highest = 0, lowest = kNoLabel;
  for (size_t i = 0; i < kSize; ++i) {
    high[i] = halo[i];
    low[i] = halo[i] ? halo[i] : kNoLabel;
    highest = larger(highest, high[i]);
    lowest = smaller(lowest, low[i]);
  }
  if (highest <= lowest) return {highest, lowest};
  // Along one axis after the other.
  constexpr size_t x = detail::kHaloStride[0], y = detail::kHaloStride[1];
  int32_t highZ[kSize], lowZ[kSize];
  for (size_t i = 1; i < kSize - 1; ++i) {
    highZ[i] = larger(high[i], larger(high[i - 1], high[i + 1]));
    lowZ[i] = smaller(low[i], smaller(low[i - 1], low[i + 1]));
  }
  for (size_t i = 1 + y; i < kSize - 1 - y; ++i) {
    high[i] = larger(highZ[i], larger(highZ[i - y], highZ[i + y]));
    low[i] = smaller(lowZ[i], smaller(lowZ[i - y], lowZ[i + y]));
  }
  for (size_t i = 1 + y + x; i < kSize - 1 - y - x; ++i) {
    largest[i] = larger(high[i], larger(high[i - x], high[i + x]));
    smallest[i] = smaller(low[i], smaller(low[i - x], low[i + x]));
  }
  return {highest, lowest};
}

/// f(label) for each labeled voxel of the leaf.
template <typename F>
void forEachLabel(const detail::LabelHalo& halo, const F& f) {
  for (int x = 0; x < 8; ++x)
    for (int y = 0; y < 8; ++y)
      for (int z = 0; z < 8; ++z)
        if (const int32_t label = halo[detail::haloAt(x, y, z)]) f(label);
}

/// f(a, b) for all different labels at 26-adjacent voxels of which one lies in the leaf; pairs
/// may come more than once.
template <typename F>
void forEachContact(const detail::LabelHalo& halo, const F& f) {
  detail::LabelHalo largest, smallest;
  const auto [highest, lowest] = detail::atBestLevel(
      [&]() VDB_MADF_INLINE { return extremesOf(halo.data(), largest.data(), smallest.data()); });
  if (highest <= lowest) return;
  for (int x = 0; x < 8; ++x)
    for (int y = 0; y < 8; ++y)
      for (int z = 0; z < 8; ++z) {
        const auto at = int(detail::haloAt(x, y, z));
        const int32_t a = halo[size_t(at)];
        if (!a || largest[size_t(at)] == smallest[size_t(at)]) continue;
        // All 26: a neighbor in another leaf may be the only one to see it, or not be a leaf.
        const auto contact = [&](int32_t b) {
          if (b && b != a) f(smaller(a, b), larger(a, b));
        };
        for (const int step : kForward) {
          contact(halo[size_t(at + step)]);
          contact(halo[size_t(at - step)]);
        }
      }
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
  detail::parallelFor(index.leafCount(), detail::kLeafGrain, interrupter,
                      [&](size_t begin, size_t end) {
                        std::vector<int32_t> someLabels;
                        std::vector<Pair> somePairs;
                        detail::LabelHalo halo;
                        for (size_t i = begin; i < end; ++i) {
                          detail::readLabelHalo(grid.tree(), index.origin(i), halo);
                          forEachLabel(halo, [&](int32_t label) {
                            if (someLabels.empty() || someLabels.back() != label)
                              someLabels.push_back(label);
                          });
                          forEachContact(halo, [&](int32_t a, int32_t b) {
                            if (somePairs.empty() || somePairs.back() != Pair(a, b))
                              somePairs.emplace_back(a, b);
                          });
                        }
                        detail::sortUnique(somePairs);
                        // Sets: the order in which the parts arrive does not matter.
                        const std::lock_guard<std::mutex> lock(mutex);
                        labels.insert(someLabels.begin(), someLabels.end());
                        pairs.insert(pairs.end(), somePairs.begin(), somePairs.end());
                      });
  detail::sortUnique(pairs);
  return {{labels.begin(), labels.end()}, std::move(pairs)};
}

/// The union of two sorted lists.
template <typename T>
std::vector<T> united(const std::vector<T>& a, const std::vector<T>& b) {
  std::vector<T> all;
  all.reserve(std::max(a.size(), b.size()));
  std::set_union(a.begin(), a.end(), b.begin(), b.end(), std::back_inserter(all));
  return all;
}

using Graph = std::vector<std::vector<uint32_t>>;  ///< the neighbors of each label's index

Graph asGraph(const std::vector<int32_t>& labels, const std::vector<Pair>& pairs) {
  const auto indexOf = [&](int32_t label) { return uint32_t(detail::sortedIndex(labels, label)); };
  Graph graph(labels.size());
  for (const auto& [a, b] : pairs) {
    const uint32_t i = indexOf(a), j = indexOf(b);
    graph[i].push_back(j);
    graph[j].push_back(i);
  }
  return graph;
}

/// The reverse of: take away, again and again, a node of least remaining degree. Each node then has
/// few neighbors before it: as many as that degree.
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

/// Where the label's search of the palette begins: mixed, so that all colors come into use (the
/// multiplier is 2^32 divided by the golden ratio).
size_t preference(int32_t label) {
  return size_t((uint64_t(uint32_t(label) * 2654435769u) * kFirstChoice) >> 32);
}

/// The first color that is not `used`, else the preferred one.
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

void GrainColoring::add(const Int32Grid& part, Interrupter* interrupter) {
  const Contacts contacts = findContacts(part, interrupter);
  labels_ = united(labels_, contacts.labels);
  pairs_ = united(pairs_, contacts.pairs);
}

GrainColors GrainColoring::colors() const {
  const Graph graph = asGraph(labels_, pairs_);
  std::vector<size_t> color(graph.size(), kPaletteSize);  // none yet
  for (const uint32_t node : smallestLast(graph)) {
    std::array<bool, kPaletteSize> used{};
    for (const uint32_t other : graph[node])
      if (color[other] < kPaletteSize) used[color[other]] = true;
    color[node] = pick(labels_[node], used);
  }

  GrainColors result;
  result.labels = labels_;
  result.touchingPairs = int64_t(pairs_.size());
  for (const size_t c : color) result.colors.push_back(kPalette[c]);
  for (uint32_t i = 0; i < graph.size(); ++i)
    for (const uint32_t j : graph[i]) result.alikePairs += i < j && color[i] == color[j];
  return result;
}

GrainColors grainColors(const Int32Grid& labels, Interrupter* interrupter) {
  GrainColoring coloring;
  coloring.add(labels, interrupter);
  return coloring.colors();
}

void GrainColoring::add(const LabelSlabs& parts, Interrupter* interrupter) {
  detail::RimmedSlabs slabs(parts);
  while (slabs.next(interrupter)) add(slabs.labels(), interrupter);
}

GrainColors grainColors(const LabelSlabs& labels, Interrupter* interrupter) {
  GrainColoring coloring;
  coloring.add(labels, interrupter);
  return coloring.colors();
}

}  // namespace vdb_madf
