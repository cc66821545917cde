// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/method/stable_strictness.h"

#include <algorithm>
#include <cmath>

#include "vdb_madf/method/grain_lives.h"

namespace vdb_madf {

namespace {

constexpr int kFirst = 80, kDefault = 110, kLast = 140, kTenths = 10;

/// In units of the score: sums of whole numbers do not depend on their order.
int64_t stabilityOf(const GrainLife& life, double strictness) {
  constexpr int64_t kMost = Hierarchy::kUnitsOfScore;
  const auto units = [](double number) { return std::lround(number * Hierarchy::kUnitsOfScore); };
  int64_t least = kMost;
  if (life.born) least = std::min<int64_t>(least, units(*life.born) - units(strictness));
  if (life.dies) least = std::min<int64_t>(least, units(strictness) - units(*life.dies));
  return least;
}

std::optional<std::pair<double, double>> plateauOf(
    const std::vector<StableStrictness::Level>& levels) {
  std::optional<std::pair<double, double>> widest;
  size_t width = kTenths - 1;
  for (size_t from = 0; from < levels.size(); ++from)
    for (size_t to = from + width + 1; to < levels.size(); ++to)
      if (20 * (levels[to].grains - levels[from].grains) < levels[from].grains) {
        width = to - from;
        widest = {levels[from].strictness, levels[to].strictness};
      }
  return widest;
}

}  // namespace

StableStrictness stableStrictness(const Hierarchy& hierarchy) {
  StableStrictness result;
  int64_t largest = -1;
  for (int tenths = kFirst; tenths <= kLast; ++tenths) {
    const double strictness = double(tenths) / kTenths;
    const Merging merging = cut(hierarchy, strictness);
    const GrainLives lives(hierarchy, strictness);
    const std::vector<int64_t> voxels = grainVoxels(hierarchy, merging);
    int64_t sum = 0, all = 0;
    for (size_t g = 0; g < voxels.size(); ++g) {
      sum += voxels[g] * stabilityOf(lives.of(merging.representative[g]), strictness);
      all += voxels[g];
    }
    const auto stability =
        double(sum) / double(std::max<int64_t>(1, all)) / Hierarchy::kUnitsOfScore;
    result.levels.push_back({strictness, int64_t(voxels.size()), stability});
    const bool isNearer =
        std::abs(tenths - kDefault) < std::abs(std::lround(result.strictness * kTenths) - kDefault);
    if (sum > largest || (sum == largest && isNearer)) {
      largest = sum;
      result.strictness = strictness;
    }
  }
  result.plateau = plateauOf(result.levels);
  return result;
}

}  // namespace vdb_madf
