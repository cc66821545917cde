// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/matching/detail/grain_set.h"

#include <openvdb/tree/ValueAccessor.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <mutex>

#include "vdb_madf/base/detail/parallel.h"
#include "vdb_madf/grids/detail/ball_steps.h"
#include "vdb_madf/grids/detail/leaf_nodes.h"
#include "vdb_madf/leaves/detail/leaf_mask.h"
#include "vdb_madf/leaves/detail/voxels.h"

namespace vdb_madf::detail {

namespace {

using Wide = __int128;
using Leaf = Int32Tree::LeafNodeType;
using PairCounts = std::map<LabelPair, int64_t>;
using Values = openvdb::tree::ValueAccessor<const Int32Tree>;

/// Integer sums: the order in which voxels come does not matter.
struct PlaceSums {
  int64_t voxels = 0;
  std::array<int64_t, 3> sum{};
  std::array<Wide, 6> products{};  ///< xx, yy, zz, xy, xz, yz
  bool isCut = false;

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
    isCut = isCut || other.isCut;
  }
};

/// Tells the voxels beside which a domain ends; near ones one after the other.
class AtEnd {
 public:
  explicit AtEnd(const std::optional<Domain>& domain) : domain_(domain) {}
  bool operator()(const Coord& p) {
    if (!domain_) return false;
    const Coord origin = p & ~7;
    if (!inner_ || origin != origin_) {
      origin_ = origin;
      inner_ = innerMask(*domain_, origin);
    }
    const openvdb::Index offset = Leaf::coordToOffset(p);
    return !((*inner_)[offset >> 6] >> (offset & 63) & 1);
  }

 private:
  const std::optional<Domain>& domain_;
  Coord origin_;
  std::optional<LeafIndex::Mask> inner_;
};

GrainFeatures featuresOf(int32_t label, const PlaceSums& sums) {
  GrainFeatures grain;
  grain.grain = label;
  const double n = double(sums.voxels);
  grain.volume = n;
  grain.isCut = sums.isCut;
  for (size_t axis = 0; axis < 3; ++axis) grain.center[int(axis)] = double(sums.sum[axis]) / n;
  constexpr size_t kFirst[6] = {0, 1, 2, 0, 0, 1}, kSecond[6] = {0, 1, 2, 1, 2, 2};
  for (size_t k = 0; k < 6; ++k) {
    const Wide exact =
        sums.voxels * sums.products[k] - Wide(sums.sum[kFirst[k]]) * sums.sum[kSecond[k]];
    grain.moments[k] = double(exact) / (n * n) + (k < 3 ? 1. / 12 : 0);
  }
  return grain;
}

/// The leaves of a part that are its own.
std::vector<const Leaf*> ownLeaves(const ScanLabels::Part& part) {
  std::vector<const Leaf*> leaves = leavesOf(*part.tree);
  leaves.erase(std::remove_if(leaves.begin(), leaves.end(),
                              [&](const Leaf* leaf) { return !part.isOwn(leaf->origin()); }),
               leaves.end());
  return leaves;
}

/// Lets add(voxel, label, sums) see labeled voxels, by any thread, and merge(sums) what each of
/// them made of its own, one after the other: sums and sets, as the order is any.
template <typename Sums, typename MakeAdd, typename Merge>
void forEachVoxel(const std::vector<const Leaf*>& leaves, size_t grain, Interrupter* interrupter,
                  const MakeAdd& makeAdd, const Merge& merge) {
  std::mutex mutex;
  parallelFor(leaves.size(), grain, interrupter, [&](size_t begin, size_t end) {
    Sums sums;
    auto add = makeAdd();
    for (size_t n = begin; n < end; ++n)
      for (auto voxel = leaves[n]->cbeginValueOn(); voxel; ++voxel)
        if (*voxel > 0) add(voxel.getCoord(), *voxel, sums);
    const std::lock_guard<std::mutex> lock(mutex);
    merge(sums);
  });
}

/// Adds what is counted for pairs of labels.
template <typename MakeAdd>
void count(const std::vector<const Leaf*>& leaves, PairCounts& counts, Interrupter* interrupter,
           const MakeAdd& makeAdd) {
  forEachVoxel<PairCounts>(leaves, kLeafGrain, interrupter, makeAdd, [&](const PairCounts& some) {
    for (const auto& [pair, number] : some) counts[pair] += number;
  });
}

/// Finds the motion of one grain after the other, which are mostly the same.
class MotionOf {
 public:
  explicit MotionOf(const Motions& motions) : motions_(motions), last_(motions.end()) {}
  /// Null if there is none.
  const Motion* operator()(int32_t label) {
    if (last_ == motions_.end() || last_->first != label) last_ = motions_.find(label);
    return last_ == motions_.end() ? nullptr : &last_->second;
  }

 private:
  const Motions& motions_;
  Motions::const_iterator last_;
};

/// The layers of another scan that some voxels come to lie in, and those beside them.
Int32Tree::ConstPtr layersThere(const std::vector<const Leaf*>& leaves, ScanLabels& other,
                                const Motions& motions, Interrupter* interrupter) {
  if (other.isWhole()) return other.layers(0, 0, interrupter);
  struct Range {
    double low = std::numeric_limits<double>::infinity(), high = -low;
  } all;
  forEachVoxel<Range>(
      leaves, kLeafGrain, interrupter,
      [&] {
        return [motion = MotionOf(motions)](const Coord& p, int32_t label, Range& range) mutable {
          const Motion* const moved = motion(label);
          if (!moved) return;
          const double z = (*moved)(p.asVec3d()).z();
          range.low = std::min(range.low, z);
          range.high = std::max(range.high, z);
        };
      },
      [&](const Range& range) {
        all.low = std::min(all.low, range.low);
        all.high = std::max(all.high, range.high);
      });
  if (!(all.low <= all.high)) return std::make_shared<Int32Tree>(0);
  constexpr double kMost = 1e9;  // no scan reaches farther
  const auto layer = [&](double z) { return int(std::floor(std::clamp(z, -kMost, kMost))); };
  return other.layers(layer(all.low) - 1, layer(all.high) + 2, interrupter);
}

/// What is labeled where a place is; 0: nothing.
int32_t labelAround(Values& values, const openvdb::Vec3d& place) {
  int32_t label = 0;
  const bool isOn = values.probeValue(Coord::floor(place + openvdb::Vec3d(0.5)), label);
  return isOn && label > 0 ? label : 0;
}

}  // namespace

ScanSums scanSums(ScanLabels& labels, const std::optional<Domain>& open, Interrupter* interrupter) {
  using Sums = std::map<int32_t, PlaceSums>;
  Sums all;
  ContactFaces faces;
  labels.forEachPart(1, interrupter, [&](const ScanLabels::Part& part) {
    const auto leaves = ownLeaves(part);
    forEachVoxel<Sums>(
        leaves, kLightLeafGrain, interrupter,
        [&] {
          return [isAtEnd = AtEnd(open)](const Coord& p, int32_t label, Sums& sums) mutable {
            PlaceSums& grain = sums[label];
            grain.add(p);
            if (isAtEnd(p)) grain.isCut = true;
          };
        },
        [&](const Sums& some) {
          for (const auto& [label, sums] : some) all[label].add(sums);
        });
    std::vector<Coord> origins;
    for (const Leaf* const leaf : leaves) origins.push_back(leaf->origin());
    addContactFaces(*part.tree, origins, faces, interrupter);
  });
  ScanSums scan;
  for (const auto& [label, sums] : all) scan.set.grains.push_back(featuresOf(label, sums));
  scan.contacts = contactsOf(faces);
  for (const auto& [pair, number] : faces) scan.set.contacts.push_back(pair);
  return scan;
}

std::set<LabelPair> nearPairs(ScanLabels& labels, const std::set<LabelPair>& pairs, int gap,
                              Interrupter* interrupter) {
  std::set<LabelPair> near;
  if (pairs.empty()) return near;
  std::set<int32_t> firsts;
  for (const auto& [first, second] : pairs) firsts.insert(first);
  const auto ball = ballSteps(gap);
  labels.forEachPart(gap, interrupter, [&](const ScanLabels::Part& part) {
    const auto makeAdd = [&] {
      return [&, values = Values(*part.tree)](const Coord& p, int32_t label,
                                              std::set<LabelPair>& found) {
        if (!firsts.count(label)) return;
        int inside = 0;
        for (int axis = 0; axis < 3; ++axis)
          for (const int step : {-1, 1}) {
            Coord next = p;
            next[axis] += step;
            int32_t value = 0;
            inside += values.probeValue(next, value) && value == label;
          }
        if (inside == 6) return;
        for (const auto& [squared, step] : ball) {
          int32_t other = 0;
          if (values.probeValue(p + step, other) && other > label && pairs.count({label, other}))
            found.emplace(label, other);
        }
      };
    };
    forEachVoxel<std::set<LabelPair>>(
        ownLeaves(part), kLeafGrain, interrupter, makeAdd,
        [&](const std::set<LabelPair>& found) { near.insert(found.begin(), found.end()); });
  });
  return near;
}

std::set<LabelPair> solidPairs(ScanLabels& labels, ScanLabels& other,
                               const std::set<LabelPair>& pairs, const Motions& motions,
                               Interrupter* interrupter) {
  std::set<LabelPair> solid;
  if (pairs.empty()) return solid;
  std::set<int32_t> ends;
  for (const auto& [first, second] : pairs) ends.insert({first, second});
  PairCounts excess;  // of solid faces
  labels.forEachPart(1, interrupter, [&](const ScanLabels::Part& part) {
    const auto leaves = ownLeaves(part);
    const Int32Tree::ConstPtr there = layersThere(leaves, other, motions, interrupter);
    count(leaves, excess, interrupter, [&] {
      return [&, from = Values(*part.tree), to = Values(*there), motion = MotionOf(motions),
              motionThere = MotionOf(motions)](const Coord& p, int32_t label,
                                               PairCounts& counts) mutable {
        if (!ends.count(label)) return;
        for (int axis = 0; axis < 3; ++axis) {
          Coord next = p;
          ++next[axis];
          int32_t touched = 0;
          if (!from.probeValue(next, touched)) continue;
          const LabelPair pair = std::minmax(label, touched);
          if (!pairs.count(pair)) continue;
          const Motion *const first = motion(label), *const second = motionThere(touched);
          if (!first || !second) continue;
          const openvdb::Vec3d place = ((*first)(p.asVec3d()) + (*second)(next.asVec3d())) * 0.5;
          counts[pair] += labelAround(to, place) ? 1 : -1;
        }
      };
    });
  });
  for (const auto& [pair, faces] : excess)
    if (faces > 0) solid.insert(pair);
  return solid;
}

PairCounts movedOverlaps(ScanLabels& before, ScanLabels& after, const Motions& motions,
                         Interrupter* interrupter) {
  PairCounts overlaps;
  before.forEachPart(0, interrupter, [&](const ScanLabels::Part& part) {
    const auto leaves = ownLeaves(part);
    const Int32Tree::ConstPtr there = layersThere(leaves, after, motions, interrupter);
    count(leaves, overlaps, interrupter, [&] {
      return [&, values = Values(*there), motion = MotionOf(motions)](const Coord& p, int32_t label,
                                                                      PairCounts& counts) mutable {
        const Motion* const moved = motion(label);
        if (!moved) return;
        if (const int32_t other = labelAround(values, (*moved)(p.asVec3d())))
          ++counts[{label, other}];
      };
    });
  });
  return overlaps;
}

}  // namespace vdb_madf::detail
