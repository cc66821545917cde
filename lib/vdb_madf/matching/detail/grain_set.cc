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
#include "vdb_madf/grids/detail/ball_steps.h"
#include "vdb_madf/grids/detail/leaf_nodes.h"
#include "vdb_madf/labels/detail/label_blocks.h"
#include "vdb_madf/labels/detail/label_contacts.h"
#include "vdb_madf/leaves/detail/voxels.h"

namespace vdb_madf::detail {

namespace {

using Wide = __int128;
using Pair = std::pair<int32_t, int32_t>;
using PairCounts = std::map<Pair, int64_t>;
using Values = openvdb::tree::ValueAccessor<const Int32Tree>;

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

/// Lets add(voxel, label, part) see the labeled voxels of a tree, by any thread, and merge(part)
/// what each of them made of its own, one after the other: sums and sets, as the order is any.
template <typename Part, typename MakeAdd, typename Merge>
void forEachPart(const Int32Tree& tree, size_t grain, Interrupter* interrupter,
                 const MakeAdd& makeAdd, const Merge& merge) {
  const auto leaves = leavesOf(tree);
  std::mutex mutex;
  parallelFor(leaves.size(), grain, interrupter, [&](size_t begin, size_t end) {
    Part part;
    auto add = makeAdd();
    for (size_t n = begin; n < end; ++n)
      for (auto voxel = leaves[n]->cbeginValueOn(); voxel; ++voxel)
        if (*voxel > 0) add(voxel.getCoord(), *voxel, part);
    const std::lock_guard<std::mutex> lock(mutex);
    merge(part);
  });
}

/// The sums of what is added for pairs of labels.
template <typename MakeAdd>
PairCounts counted(const Int32Tree& tree, Interrupter* interrupter, const MakeAdd& makeAdd) {
  PairCounts counts;
  forEachPart<PairCounts>(tree, kLeafGrain, interrupter, makeAdd, [&](const PairCounts& part) {
    for (const auto& [pair, count] : part) counts[pair] += count;
  });
  return counts;
}

}  // namespace

GrainSet grainSet(const Int32Grid& labels, Interrupter* interrupter) {
  using Sums = std::map<int32_t, PlaceSums>;
  Sums all;
  forEachPart<Sums>(
      *withoutTiles(labels), kLightLeafGrain, interrupter,
      [] { return [](const Coord& p, int32_t label, Sums& part) { part[label].add(p); }; },
      [&](const Sums& part) {
        for (const auto& [label, sums] : part) all[label].add(sums);
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
  std::set<Pair> near;
  if (pairs.empty()) return near;
  std::set<int32_t> firsts;
  for (const auto& [first, second] : pairs) firsts.insert(first);
  const auto ball = ballSteps(gap);
  const Int32Tree::ConstPtr tree = withoutTiles(labels);
  const auto makeAdd = [&] {
    return [&, values = Values(*tree)](const Coord& p, int32_t label, std::set<Pair>& part) {
      if (!firsts.count(label)) return;
      int inside = 0;
      for (int axis = 0; axis < 3; ++axis)
        for (const int step : {-1, 1}) {
          Coord next = p;
          next[axis] += step;
          inside += values.getValue(next) == label;
        }
      if (inside == 6) return;
      for (const auto& [squared, step] : ball) {
        int32_t other = 0;
        if (values.probeValue(p + step, other) && other > label && pairs.count({label, other}))
          part.emplace(label, other);
      }
    };
  };
  forEachPart<std::set<Pair>>(
      *tree, kLeafGrain, interrupter, makeAdd,
      [&](const std::set<Pair>& part) { near.insert(part.begin(), part.end()); });
  return near;
}

std::set<std::pair<int32_t, int32_t>> solidPairs(const Int32Grid& before, const Int32Grid& after,
                                                 const std::set<std::pair<int32_t, int32_t>>& pairs,
                                                 const std::map<int32_t, Motion>& motions,
                                                 Interrupter* interrupter) {
  std::set<Pair> solid;
  if (pairs.empty()) return solid;
  std::set<int32_t> ends;
  for (const auto& [first, second] : pairs) ends.insert({first, second});
  const Int32Tree::ConstPtr tree = withoutTiles(before);
  const auto makeAdd = [&] {
    return [&, from = Values(*tree), to = Values(after.tree())](const Coord& p, int32_t label,
                                                                PairCounts& part) {
      if (!ends.count(label)) return;
      for (int axis = 0; axis < 3; ++axis) {
        Coord next = p;
        ++next[axis];
        const int32_t other = from.getValue(next);
        const Pair pair = std::minmax(label, other);
        if (!pairs.count(pair)) continue;
        const openvdb::Vec3d place =
            (motions.at(label)(p.asVec3d()) + motions.at(other)(next.asVec3d())) * 0.5;
        int32_t there = 0;
        const bool isSolid =
            to.probeValue(Coord::floor(place + openvdb::Vec3d(0.5)), there) && there > 0;
        part[pair] += isSolid ? 1 : -1;
      }
    };
  };
  for (const auto& [pair, excess] : counted(*tree, interrupter, makeAdd))  // of solid faces
    if (excess > 0) solid.insert(pair);
  return solid;
}

std::map<std::pair<int32_t, int32_t>, int64_t> movedOverlaps(
    const Int32Grid& before, const Int32Grid& after, const std::map<int32_t, Motion>& motions,
    Interrupter* interrupter) {
  return counted(*withoutTiles(before), interrupter, [&] {
    return [&, values = Values(after.tree()), motion = motions.end()](const Coord& p, int32_t label,
                                                                      PairCounts& part) mutable {
      if (motion == motions.end() || motion->first != label) motion = motions.find(label);
      if (motion == motions.end()) return;
      int32_t other = 0;
      const openvdb::Vec3d place = motion->second(p.asVec3d()) + openvdb::Vec3d(0.5);
      if (values.probeValue(Coord::floor(place), other) && other > 0) ++part[{label, other}];
    };
  });
}

}  // namespace vdb_madf::detail
