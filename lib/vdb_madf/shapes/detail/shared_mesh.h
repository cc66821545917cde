// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "vdb_madf/grids/grid_types.h"

namespace vdb_madf::detail {

/// The surfaces of all grains as triangles whose points still move, and go, together. A site is a
/// place in space; a point is a site as one grain sees it.
struct SharedMesh {
  static constexpr uint32_t kNone = 0xffffffffu;

  std::vector<openvdb::Vec3f> positions;           ///< of the sites
  std::vector<uint32_t> pointSite, pointGrain;     ///< grains ascend
  std::vector<uint32_t> firstTriangle{0};          ///< per grain, one more at the end
  std::vector<std::array<uint32_t, 3>> triangles;  ///< of points, counterclockwise from outside
  /// Per triangle, what is beyond it: another label, 0 for background, or less than 0 for one of
  /// the six faces of the domain.
  std::vector<int32_t> beyond;

  size_t grainCount() const { return firstTriangle.size() - 1; }
  /// The first point of each grain, and one more at the end.
  std::vector<uint32_t> firstPoints() const {
    std::vector<uint32_t> first(grainCount() + 1);
    for (const uint32_t grain : pointGrain) ++first[grain + 1];
    for (size_t g = 1; g < first.size(); ++g) first[g] += first[g - 1];
    return first;
  }
};

/// Sites on the faces of the domain stay on them.
struct DomainFaces {
  bool areKnown = false;
  openvdb::Vec3f low, high;  ///< outermost corners of its voxels

  bool isOn(const openvdb::Vec3f& p, int axis) const {
    return areKnown && (p[axis] == low[axis] || p[axis] == high[axis]);
  }
};

/// Farthest from its lattice point that a corner may go along an axis, in voxels: the net cannot
/// fold over, and the boundary between two voxels stays between their centers.
constexpr float kCornerReach = 0.5f;

/// The wanted place, but at most `reach` along an axis from `home`, in the domain, and on those of
/// its faces that `home` is on.
inline openvdb::Vec3f withinReach(const openvdb::Vec3f& home, const openvdb::Vec3f& wanted,
                                  float reach, const DomainFaces& domain) {
  openvdb::Vec3f result;
  for (int axis = 0; axis < 3; ++axis) {
    if (domain.isOn(home, axis)) {
      result[axis] = home[axis];
      continue;
    }
    result[axis] = std::clamp(wanted[axis], home[axis] - reach, home[axis] + reach);
    if (domain.areKnown)
      result[axis] = std::clamp(result[axis], domain.low[axis], domain.high[axis]);
  }
  return result;
}

/// Lists of numbers for each of `size()` keys: those of key k are [first[k], first[k + 1]).
struct Lists {
  std::vector<uint32_t> first, items;

  /// The places i of `keys`, by their keys; for each key ascending.
  Lists(const std::vector<uint32_t>& keys, size_t keyCount)
      : first(keyCount + 1), items(keys.size()) {
    for (const uint32_t key : keys) ++first[key + 1];
    for (size_t k = 1; k < first.size(); ++k) first[k] += first[k - 1];
    std::vector<uint32_t> next(first.begin(), first.end() - 1);
    for (size_t i = 0; i < keys.size(); ++i) items[next[keys[i]]++] = uint32_t(i);
  }
};

}  // namespace vdb_madf::detail
