// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/method/grain_lives.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

namespace vdb_madf {

namespace {

constexpr size_t kNever = std::numeric_limits<size_t>::max();
constexpr uint32_t kNoGrain = std::numeric_limits<uint32_t>::max();

bool isAlmost(int64_t smaller, int64_t larger) {
  return 50 * smaller >= 49 * larger;
}

}  // namespace

GrainLives::GrainLives(const Hierarchy& hierarchy, double strictness)
    : classOfNode_(hierarchy.classOfNode),
      parent_(hierarchy.classes.size()),
      join_(parent_.size(), kNever),
      cut_(joinsAt(hierarchy, strictness)),
      strictnessOfCut_(strictness),
      lives_(parent_.size()) {
  std::iota(parent_.begin(), parent_.end(), 0u);
  std::vector<uint32_t> size(parent_.size(), 1);
  for (const JoinedGrains& join : joinedGrains(hierarchy)) {
    const size_t i = strictness_.size();
    link(hierarchy.joins[i].first, hierarchy.joins[i].second, size);
    strictness_.push_back(join.strictness);
  }
  followGrains(hierarchy);
}

/// Makes the next join: the smaller tree hangs below the root of the larger.
void GrainLives::link(uint32_t first, uint32_t second, std::vector<uint32_t>& size) {
  const size_t i = strictness_.size();
  uint32_t kept = rootAt(first, i), gone = rootAt(second, i);
  if (size[kept] < size[gone]) std::swap(kept, gone);
  parent_[gone] = kept;
  join_[gone] = i;
  size[kept] += size[gone];
}

/// A grain is born when first a part of it has almost all of its voxels, and dies when what it is
/// part of has more than almost its own: so of what a join makes, at most one grain lives on.
void GrainLives::followGrains(const Hierarchy& hierarchy) {
  const auto& joins = hierarchy.joins;
  std::vector<int64_t> voxels;  // of roots
  for (const Hierarchy::Class& c : hierarchy.classes) voxels.push_back(c.voxels);
  std::vector<int64_t> grainVoxels(voxels.size(), 0);  // of roots at the cut
  for (uint32_t c = 0; c < voxels.size(); ++c) grainVoxels[rootAt(c, cut_)] += voxels[c];
  std::vector<char> isBorn(voxels.size(), 0);
  for (uint32_t c = 0; c < voxels.size(); ++c) {
    const uint32_t grain = rootAt(c, cut_);
    isBorn[grain] |= isAlmost(voxels[c], grainVoxels[grain]);
  }
  std::vector<uint32_t> alive(voxels.size(), kNoGrain);  // of roots
  for (size_t i = 0; i <= joins.size(); ++i) {
    if (i == cut_)
      for (uint32_t c = 0; c < voxels.size(); ++c)
        if (grainVoxels[c] > 0 && rootAt(c, cut_) == c) alive[c] = c;
    if (i == joins.size()) return;
    const uint32_t one = rootAt(joins[i].first, i), other = rootAt(joins[i].second, i),
                   both = rootAt(one, i + 1);
    const int64_t sum = voxels[one] + voxels[other];
    if (i < cut_) {
      const uint32_t grain = rootAt(both, cut_);
      if (!isBorn[grain] && isAlmost(sum, grainVoxels[grain])) {
        isBorn[grain] = 1;
        lives_[grain].born = strictness_[i];
      }
    } else {
      uint32_t survivor = kNoGrain;
      for (const uint32_t grain : {alive[one], alive[other]}) {
        if (grain == kNoGrain) continue;
        if (isAlmost(grainVoxels[grain], sum))
          survivor = grain;
        else
          lives_[grain].dies = strictness_[i];
      }
      alive[both] = survivor;
    }
    voxels[both] = sum;
  }
}

uint32_t GrainLives::rootAt(uint32_t aClass, size_t joins) const {
  while (join_[aClass] < joins) aClass = parent_[aClass];
  return aClass;
}

GrainLife GrainLives::of(uint32_t node) const {
  GrainLife life = lives_[rootAt(classOfNode_.at(node), cut_)];
  if (life.born) life.stability = *life.born - strictnessOfCut_;
  if (life.dies)
    life.stability = std::min(life.stability.value_or(HUGE_VAL), strictnessOfCut_ - *life.dies);
  return life;
}

std::optional<double> GrainLives::joinedAt(uint32_t first, uint32_t second) const {
  uint32_t one = rootAt(classOfNode_.at(first), cut_),
           other = rootAt(classOfNode_.at(second), cut_);
  size_t last = kNever;
  while (one != other) {
    uint32_t& earlier = join_[one] < join_[other] ? one : other;
    last = join_[earlier];
    if (last == kNever) return std::nullopt;
    earlier = parent_[earlier];
  }
  if (last == kNever) return std::nullopt;
  return strictness_[last];
}

}  // namespace vdb_madf
