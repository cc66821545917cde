// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <algorithm>
#include <cstddef>
#include <limits>
#include <utility>
#include <vector>

#include "vdb_madf/base/detail/parallel.h"
#include "vdb_madf/matching/detail/point_cells.h"
#include "vdb_madf/matching/match_grains.h"

namespace vdb_madf::detail {

constexpr size_t kNoIndex = std::numeric_limits<size_t>::max();
constexpr size_t kAround = 24;  // neighbors of a grain: those in reach of about two spacings
constexpr size_t kGrainsPerTask = 64;

/// Grains of a smaller volume are specks, as the noise of a scan leaves them: a fiftieth of the
/// grain in the middle of the mass, if all that are smaller hold less than a tenth of it.
inline double leastVolume(const std::vector<GrainFeatures>& grains) {
  std::vector<double> volumes;
  double all = 0, sum = 0;
  for (const GrainFeatures& grain : grains) volumes.push_back(grain.volume);
  std::sort(volumes.begin(), volumes.end());
  for (const double volume : volumes) all += volume;
  double middle = 0;
  for (size_t n = 0; n < volumes.size() && 2 * sum < all; ++n) sum += middle = volumes[n];
  double small = 0;
  for (const double volume : volumes)
    if (volume < middle / 50) small += volume;
  return small < all / 10 ? middle / 50 : 0;
}

/// A scan's grains, and who is near whom. Neighbors are no specks.
struct ScanGrains {
  const std::vector<GrainFeatures>& grains;
  std::vector<char> isSpeck;
  std::vector<size_t> bodies;  ///< those that are no specks
  PointCells cells, bodyCells;
  std::vector<std::vector<size_t>> around, contacts;
  std::vector<double> spacing;  ///< mean distance of the nearest six; of a speck, specks or not

  ScanGrains(const GrainSet& set, Interrupter* interrupter)
      : grains(set.grains),
        isSpeck(specksOf(set.grains)),
        bodies(bodiesOf(isSpeck)),
        cells(centersOf(set.grains)),
        bodyCells(centersOf(set.grains, bodies)),
        around(grains.size()),
        contacts(grains.size()),
        spacing(grains.size(), 1) {
    parallelFor(size(), kGrainsPerTask, interrupter, [&](size_t begin, size_t end) {
      for (size_t at = begin; at < end; ++at) {  // near ones together, for the cache
        const size_t n = cells.inCells()[at];
        around[n] = aroundOf(n, kAround);
        const std::vector<size_t> near =
            isSpeck[n] ? others(n, cells.nearest(center(n), 7)) : around[n];
        const size_t few = std::min<size_t>(6, near.size());
        double sum = 0;
        for (size_t k = 0; k < few; ++k) sum += (center(near[k]) - center(n)).length();
        if (sum > 0) spacing[n] = sum / double(few);
      }
    });
    for (const auto& [a, b] : set.contacts) {
      const size_t first = find(a), second = find(b);
      if (first == kNoIndex || second == kNoIndex) continue;
      contacts[first].push_back(second);
      contacts[second].push_back(first);
    }
    for (auto& touched : contacts) std::sort(touched.begin(), touched.end());
  }

  size_t size() const { return grains.size(); }
  const openvdb::Vec3d& center(size_t n) const { return cells[n]; }
  bool touch(size_t a, size_t b) const {
    return std::binary_search(contacts[a].begin(), contacts[a].end(), b);
  }
  std::vector<size_t> aroundOf(size_t n, size_t most) const {
    std::vector<size_t> found = bodyCells.nearest(center(n), most + 1);
    for (size_t& other : found) other = bodies[other];
    found = others(n, std::move(found));
    if (found.size() > most) found.pop_back();
    return found;
  }

 private:
  static std::vector<size_t> others(size_t n, std::vector<size_t> found) {
    found.erase(std::remove(found.begin(), found.end(), n), found.end());
    return found;
  }
  static std::vector<char> specksOf(const std::vector<GrainFeatures>& grains) {
    const double least = leastVolume(grains);
    std::vector<char> specks;
    for (const GrainFeatures& grain : grains) specks.push_back(grain.volume < least);
    return specks;
  }
  static std::vector<size_t> bodiesOf(const std::vector<char>& isSpeck) {
    std::vector<size_t> bodies;
    for (size_t n = 0; n < isSpeck.size(); ++n)
      if (!isSpeck[n]) bodies.push_back(n);
    return bodies;
  }
  static std::vector<openvdb::Vec3d> centersOf(const std::vector<GrainFeatures>& grains,
                                               const std::vector<size_t>& which) {
    std::vector<openvdb::Vec3d> centers;
    for (const size_t n : which) centers.push_back(grains[n].center);
    return centers;
  }
  static std::vector<openvdb::Vec3d> centersOf(const std::vector<GrainFeatures>& grains) {
    std::vector<openvdb::Vec3d> centers;
    for (const GrainFeatures& grain : grains) centers.push_back(grain.center);
    return centers;
  }
  size_t find(int32_t number) const {
    const auto found =
        std::lower_bound(grains.begin(), grains.end(), number,
                         [](const GrainFeatures& g, int32_t wanted) { return g.grain < wanted; });
    return found != grains.end() && found->grain == number ? size_t(found - grains.begin())
                                                           : kNoIndex;
  }
};

/// A volume is 0.6 to 1.6 times another one.
inline bool alikeInVolume(const GrainFeatures& a, const GrainFeatures& b) {
  return b.volume >= 0.6 * a.volume && b.volume <= 1.6 * a.volume;
}

}  // namespace vdb_madf::detail
