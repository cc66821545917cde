// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/measure/detail/label_sums.h"

#include <algorithm>
#include <optional>
#include <tuple>
#include <unordered_map>

#include "vdb_madf/base/detail/parallel.h"
#include "vdb_madf/leaves/detail/leaf_mask.h"

namespace vdb_madf::detail {

namespace {

constexpr size_t kSummedBondGrain = 16;

/// Number, sum and sum of squares of the set bits' positions.
struct BitSums {
  int32_t count = 0, sum = 0, squares = 0;
};
constexpr std::array<BitSums, 256> makeBitSums() {
  std::array<BitSums, 256> table{};
  for (unsigned bits = 0; bits < 256; ++bits) {
    for (int z = 0; z < 8; ++z) {
      if (!(bits >> z & 1)) continue;
      table[bits].count += 1;
      table[bits].sum += z;
      table[bits].squares += z * z;
    }
  }
  return table;
}
constexpr std::array<BitSums, 256> kBitSums = makeBitSums();

/// Sums over voxels of one label in one leaf, relative to its origin.
struct LeafSums {
  int32_t voxels = 0;
  std::array<int32_t, 3> sum{};
  std::array<int32_t, 6> products{};
  Coord min{8}, max{-1};

  /// The voxels (x, y, z) with a bit z.
  void add(int x, int y, unsigned bits) {
    const auto [n, z1, z2] = kBitSums[bits];
    voxels += n;
    sum[0] += n * x;
    sum[1] += n * y;
    sum[2] += z1;
    products[0] += n * x * x;
    products[1] += n * y * y;
    products[2] += z2;
    products[3] += n * x * y;
    products[4] += x * z1;
    products[5] += y * z1;
    min.minComponent(Coord(x, y, __builtin_ctz(bits)));
    max.maxComponent(Coord(x, y, 31 - __builtin_clz(bits)));
  }
};

LeafSums sumsOf(const LabelPart& part) {
  LeafSums sums;
  for (int x = 0; x < 8; ++x)
    for (int y = 0; y < 8; ++y)
      if (const auto bits = unsigned(part.mask[size_t(x)] >> 8 * y & 0xff)) sums.add(x, y, bits);
  return sums;
}

/// Adds a leaf whose origin lies at `at` from the origin of all sums.
void add(const LeafSums& leaf, const Coord& at, const Coord& origin, GrainSums& grain) {
  const int64_t n = leaf.voxels, o[3] = {at.x(), at.y(), at.z()};
  const int64_t s[3] = {leaf.sum[0], leaf.sum[1], leaf.sum[2]};
  grain.voxels += n;
  for (size_t i = 0; i < 3; ++i) {
    grain.sum[i] += n * o[i] + s[i];
    grain.products[i] += n * o[i] * o[i] + 2 * o[i] * s[i] + leaf.products[i];
  }
  for (size_t k = 3; k < 6; ++k) {
    const size_t i = k == 5 ? 1 : 0, j = k == 3 ? 1 : 2;
    grain.products[k] += n * o[i] * o[j] + o[i] * s[j] + o[j] * s[i] + leaf.products[k];
  }
  grain.box.expand(CoordBBox(origin + leaf.min, origin + leaf.max));
}

/// Adds faces whose centers are relative to a place `at` from the origin of all sums.
void addCut(const LeafSurface::CutFaces& from, const Coord& at, GrainSums& to) {
  auto cut = std::find_if(to.cuts.begin(), to.cuts.end(),
                          [&](const auto& known) { return known.side == from.side; });
  if (cut == to.cuts.end()) {
    cut = to.cuts.emplace(cut);
    cut->side = from.side;
  }
  cut->faces += from.faces;
  for (size_t i = 0; i < 3; ++i) cut->sum[i] += from.sum[i] + 2 * from.faces * at[int(i)];
}

void add(const GrainSums& from, GrainSums& to) {
  to.voxels += from.voxels;
  for (size_t i = 0; i < 3; ++i) to.sum[i] += from.sum[i];
  for (size_t i = 0; i < 6; ++i) to.products[i] += from.products[i];
  to.box.expand(from.box);
  to.freeArea += from.freeArea;
  for (const LeafSurface::CutFaces& cut : from.cuts) addCut(cut, Coord(0), to);
  to.atRegionWall = to.atRegionWall || from.atRegionWall;
}

struct PairHash {
  size_t operator()(const std::pair<int32_t, int32_t>& pair) const {
    return size_t(pair.first) * 0x9e3779b97f4a7c15ull ^ size_t(pair.second);
  }
};

/// What one thread sees.
class LeafCounter {
 public:
  std::unordered_map<int32_t, GrainSums> grains;
  std::unordered_map<std::pair<int32_t, int32_t>, BondSums, PairHash> bonds;

  LeafCounter(const LabelLeaves& labels, const Coord& origin, const Domain& domain, bool open,
              const VoxelShape& voxel)
      : labels_(&labels),
        domain_(domain),
        origin_(origin),
        surface_(labels, open ? std::optional(domain) : std::nullopt, voxel) {}

  void count(size_t leaf) {
    const Coord& at = labels_->index().origin(leaf);
    const LeafIndex::Mask wall = domain_.isBox() ? LeafIndex::Mask{} : wallMask(leaf);
    for (const LabelPart& part : labels_->parts(leaf)) {
      GrainSums& grain = grains[part.label];
      add(sumsOf(part), at - origin_, at, grain);
      grain.atRegionWall = grain.atRegionWall || meet(part.mask, wall);
    }
    surface_.measure(leaf);
    for (const LeafSurface::Free& free : surface_.free()) {
      GrainSums& grain = grains[free.label];
      grain.freeArea += free.area;
      for (const LeafSurface::CutFaces& cut : free.cuts) addCut(cut, at - origin_, grain);
    }
    for (const LeafSurface::Shared& shared : surface_.shared()) {
      BondSums& bond = bonds[{shared.first, shared.second}];
      for (size_t i = 0; i < 3; ++i) bond.areas[i] += shared.areas[i];
      bond.faces.insert(bond.faces.end(), shared.faces.begin(), shared.faces.end());
    }
  }

 private:
  /// The voxels that have a face neighbor outside the domain.
  LeafIndex::Mask wallMask(size_t leaf) const {
    return without(labels_->index().mask(leaf), innerMask(domain_, labels_->index().origin(leaf)));
  }

  const LabelLeaves* labels_;
  Domain domain_;
  Coord origin_;
  LeafSurface surface_;
};

bool faceOrder(const InterfaceFace& a, const InterfaceFace& b) {
  return std::tie(a.lower, a.axis) < std::tie(b.lower, b.axis);
}

}  // namespace

LabelSums::LabelSums(const Coord& origin, const Domain& domain, bool open, const VoxelShape& voxel)
    : origin_(origin), domain_(domain), open_(open), voxel_(voxel) {}

void LabelSums::add(const LabelLeaves& labels, const LeafLayers& layers, Interrupter* interrupter) {
  const LeafIndex& index = labels.index();
  PerThread<LeafCounter> counters(
      [&] { return LeafCounter(labels, origin_, domain_, open_, voxel_); });
  parallelFor(index.leafCount(), kLeafGrain, interrupter, [&](size_t begin, size_t end) {
    LeafCounter& counter = counters.local();
    for (size_t leaf = begin; leaf < end; ++leaf)
      if (layers.hold(index.origin(leaf))) counter.count(leaf);
  });
  for (LeafCounter& counter : counters) {
    for (const auto& [label, sums] : counter.grains) detail::add(sums, grains_[label]);
    for (auto& [pair, sums] : counter.bonds) {
      BondSums& bond = bonds_[pair];
      for (size_t i = 0; i < 3; ++i) bond.areas[i] += sums.areas[i];
      bond.faces.insert(bond.faces.end(), sums.faces.begin(), sums.faces.end());
    }
    counter.grains.clear();
    counter.bonds.clear();
  }
}

std::vector<GrainSums> LabelSums::grains() const {
  std::vector<GrainSums> result;
  result.reserve(grains_.size());
  for (const auto& [label, sums] : grains_) {
    result.push_back(sums);
    result.back().label = label;
  }
  return result;
}

std::vector<BondSums> LabelSums::takeBonds(
    const std::function<bool(int32_t first, int32_t second)>& isComplete,
    Interrupter* interrupter) {
  std::vector<BondSums> taken;
  for (auto bond = bonds_.begin(); bond != bonds_.end();) {
    const auto [first, second] = bond->first;
    if (!isComplete(first, second)) {
      ++bond;
      continue;
    }
    if (!bond->second.faces.empty()) {  // else pairs of voxels apart, beside the rim
      taken.push_back(std::move(bond->second));
      taken.back().first = first;
      taken.back().second = second;
    }
    bond = bonds_.erase(bond);
  }
  parallelForEach(taken.size(), kSummedBondGrain, interrupter, [&](size_t i) {
    std::sort(taken[i].faces.begin(), taken[i].faces.end(), faceOrder);
  });
  return taken;
}

}  // namespace vdb_madf::detail
