// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/matching/detail/grain_set.h"

#include <openvdb/tree/ValueAccessor.h>

#include <algorithm>
#include <array>
#include <map>
#include <mutex>
#include <vector>

#include "vdb_madf/base/detail/parallel.h"
#include "vdb_madf/grids/detail/leaf_nodes.h"
#include "vdb_madf/labels/detail/label_blocks.h"
#include "vdb_madf/labels/detail/label_contacts.h"
#include "vdb_madf/leaves/detail/voxels.h"

namespace vdb_madf::detail {

namespace {

using Wide = __int128;
using LabelLeaf = Int32Tree::LeafNodeType;

/// Integer sums: the order in which voxels come does not matter.
struct PlaceSums {
  int64_t voxels = 0;
  std::array<int64_t, 3> sum{};
  std::array<Wide, 6> products{};  ///< xx, yy, zz, xy, xz, yz

  void add(const Coord& p) {
    const int64_t x = p.x(), y = p.y(), z = p.z();
    ++voxels;
    sum[0] += x;
    sum[1] += y;
    sum[2] += z;
    products[0] += x * x;
    products[1] += y * y;
    products[2] += z * z;
    products[3] += x * y;
    products[4] += x * z;
    products[5] += y * z;
  }
  void add(const PlaceSums& other) {
    voxels += other.voxels;
    for (size_t n = 0; n < 3; ++n) sum[n] += other.sum[n];
    for (size_t n = 0; n < 6; ++n) products[n] += other.products[n];
  }
};

GrainFeatures featuresOf(int32_t label, const PlaceSums& sums) {
  GrainFeatures grain;
  grain.grain = label;
  const double n = double(sums.voxels);
  grain.volume = n;
  for (size_t axis = 0; axis < 3; ++axis) grain.center[int(axis)] = double(sums.sum[axis]) / n;
  constexpr size_t kFirst[6] = {0, 1, 2, 0, 0, 1}, kSecond[6] = {0, 1, 2, 1, 2, 2};
  for (size_t k = 0; k < 6; ++k) {
    const Wide exact =
        sums.voxels * sums.products[k] - Wide(sums.sum[kFirst[k]]) * sums.sum[kSecond[k]];
    grain.moments[k] = double(exact) / (n * n) + (k < 3 ? 1. / 12 : 0);
  }
  return grain;
}

/// f(voxel, label) for the labeled voxels of a leaf.
template <typename F>
void forEachLabeled(const LabelLeaf& leaf, const F& f) {
  for (auto voxel = leaf.cbeginValueOn(); voxel; ++voxel)
    if (*voxel > 0) f(voxel.getCoord(), *voxel);
}

std::vector<Coord> ballOf(int radius) {
  std::vector<Coord> ball;
  for (int x = -radius; x <= radius; ++x)
    for (int y = -radius; y <= radius; ++y)
      for (int z = -radius; z <= radius; ++z)
        if (x * x + y * y + z * z <= radius * radius) ball.emplace_back(x, y, z);
  return ball;
}

}  // namespace

GrainSet grainSet(const Int32Grid& labels, Interrupter* interrupter) {
  const Int32Tree::ConstPtr tree = withoutTiles(labels);
  const auto leaves = leavesOf(*tree);
  std::map<int32_t, PlaceSums> all;
  std::mutex mutex;
  parallelFor(leaves.size(), kLightLeafGrain, interrupter, [&](size_t begin, size_t end) {
    std::map<int32_t, PlaceSums> local;
    for (size_t n = begin; n < end; ++n)
      forEachLabeled(*leaves[n], [&](const Coord& p, int32_t label) { local[label].add(p); });
    const std::lock_guard<std::mutex> lock(mutex);
    for (const auto& [label, sums] : local) all[label].add(sums);
  });
  GrainSet set;
  for (const auto& [label, sums] : all) set.grains.push_back(featuresOf(label, sums));
  for (const LabelContact& contact : labelContacts(labels, interrupter))
    set.contacts.emplace_back(contact.first, contact.second);
  return set;
}

std::set<std::pair<int32_t, int32_t>> nearPairs(const Int32Grid& labels,
                                                const std::set<std::pair<int32_t, int32_t>>& pairs,
                                                int gap, Interrupter* interrupter) {
  std::set<std::pair<int32_t, int32_t>> near;
  if (pairs.empty()) return near;
  std::set<int32_t> firsts;
  for (const auto& [first, second] : pairs) firsts.insert(first);
  const std::vector<Coord> ball = ballOf(gap);
  const Int32Tree::ConstPtr tree = withoutTiles(labels);
  const auto leaves = leavesOf(*tree);
  std::mutex mutex;
  parallelFor(leaves.size(), kLeafGrain, interrupter, [&](size_t begin, size_t end) {
    openvdb::tree::ValueAccessor<const Int32Tree> values(*tree);
    std::set<std::pair<int32_t, int32_t>> local;
    for (size_t n = begin; n < end; ++n)
      forEachLabeled(*leaves[n], [&](const Coord& p, int32_t label) {
        if (!firsts.count(label)) return;
        int inside = 0;
        for (int axis = 0; axis < 3; ++axis)
          for (const int step : {-1, 1}) {
            Coord next = p;
            next[axis] += step;
            inside += values.getValue(next) == label;
          }
        if (inside == 6) return;
        for (const Coord& step : ball) {
          int32_t other = 0;
          if (values.probeValue(p + step, other) && other > label && pairs.count({label, other}))
            local.emplace(label, other);
        }
      });
    const std::lock_guard<std::mutex> lock(mutex);
    near.insert(local.begin(), local.end());
  });
  return near;
}

std::set<std::pair<int32_t, int32_t>> solidPairs(const Int32Grid& before, const Int32Grid& after,
                                                 const std::set<std::pair<int32_t, int32_t>>& pairs,
                                                 const std::map<int32_t, Motion>& motions,
                                                 Interrupter* interrupter) {
  std::set<std::pair<int32_t, int32_t>> solid;
  if (pairs.empty()) return solid;
  std::set<int32_t> ends;
  for (const auto& [first, second] : pairs) ends.insert({first, second});
  std::map<std::pair<int32_t, int32_t>, int64_t> excess;  // of solid faces over others
  const Int32Tree::ConstPtr tree = withoutTiles(before);
  const auto leaves = leavesOf(*tree);
  std::mutex mutex;
  parallelFor(leaves.size(), kLeafGrain, interrupter, [&](size_t begin, size_t end) {
    openvdb::tree::ValueAccessor<const Int32Tree> from(*tree), to(after.tree());
    std::map<std::pair<int32_t, int32_t>, int64_t> local;
    for (size_t n = begin; n < end; ++n)
      forEachLabeled(*leaves[n], [&](const Coord& p, int32_t label) {
        if (!ends.count(label)) return;
        for (int axis = 0; axis < 3; ++axis) {
          Coord next = p;
          ++next[axis];
          const int32_t other = from.getValue(next);
          const std::pair<int32_t, int32_t> pair = std::minmax(label, other);
          if (!pairs.count(pair)) continue;
          const openvdb::Vec3d place =
              (motions.at(label)(p.asVec3d()) + motions.at(other)(next.asVec3d())) * 0.5;
          int32_t there = 0;
          const bool isSolid =
              to.probeValue(Coord::floor(place + openvdb::Vec3d(0.5)), there) && there > 0;
          local[pair] += isSolid ? 1 : -1;
        }
      });
    const std::lock_guard<std::mutex> lock(mutex);
    for (const auto& [pair, count] : local) excess[pair] += count;
  });
  for (const auto& [pair, count] : excess)
    if (count > 0) solid.insert(pair);
  return solid;
}

std::map<std::pair<int32_t, int32_t>, int64_t> movedOverlaps(
    const Int32Grid& before, const Int32Grid& after, const std::map<int32_t, Motion>& motions,
    Interrupter* interrupter) {
  std::map<std::pair<int32_t, int32_t>, int64_t> overlaps;
  const Int32Tree::ConstPtr tree = withoutTiles(before);
  const auto leaves = leavesOf(*tree);
  std::mutex mutex;
  parallelFor(leaves.size(), kLeafGrain, interrupter, [&](size_t begin, size_t end) {
    openvdb::tree::ValueAccessor<const Int32Tree> values(after.tree());
    std::map<std::pair<int32_t, int32_t>, int64_t> local;
    auto motion = motions.end();
    for (size_t n = begin; n < end; ++n)
      forEachLabeled(*leaves[n], [&](const Coord& p, int32_t label) {
        if (motion == motions.end() || motion->first != label) motion = motions.find(label);
        if (motion == motions.end()) return;
        int32_t other = 0;
        const openvdb::Vec3d place = motion->second(p.asVec3d()) + openvdb::Vec3d(0.5);
        if (values.probeValue(Coord::floor(place), other) && other > 0) ++local[{label, other}];
      });
    const std::lock_guard<std::mutex> lock(mutex);
    for (const auto& [pair, voxels] : local) overlaps[pair] += voxels;
  });
  return overlaps;
}

}  // namespace vdb_madf::detail
