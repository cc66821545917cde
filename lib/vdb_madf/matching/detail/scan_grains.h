// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <algorithm>
#include <cstddef>
#include <limits>
#include <vector>

#include "vdb_madf/base/detail/parallel.h"
#include "vdb_madf/matching/detail/point_cells.h"
#include "vdb_madf/matching/match_grains.h"

namespace vdb_madf::detail {

constexpr size_t kNoIndex = std::numeric_limits<size_t>::max();
constexpr size_t kAround = 24;  // neighbors of a grain: those in reach of about two spacings
constexpr size_t kGrainsPerTask = 64;

/// A scan's grains, and who is near whom.
struct ScanGrains {
  const std::vector<GrainFeatures>& grains;
  PointCells cells;
  std::vector<std::vector<size_t>> around, contacts;
  std::vector<double> spacing;  ///< mean distance of the nearest six

  ScanGrains(const GrainSet& set, Interrupter* interrupter)
      : grains(set.grains),
        cells(centersOf(set.grains)),
        around(grains.size()),
        contacts(grains.size()),
        spacing(grains.size(), 1) {
    parallelFor(size(), kGrainsPerTask, interrupter, [&](size_t begin, size_t end) {
      for (size_t n = begin; n < end; ++n) around[n] = aroundOf(n, kAround);
      for (size_t n = begin; n < end; ++n) {
        const size_t few = std::min<size_t>(6, around[n].size());
        double sum = 0;
        for (size_t k = 0; k < few; ++k) sum += (center(around[n][k]) - center(n)).length();
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
    std::vector<size_t> found = cells.nearest(center(n), most + 1);
    found.erase(std::remove(found.begin(), found.end(), n), found.end());
    if (found.size() > most) found.pop_back();
    return found;
  }

 private:
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
