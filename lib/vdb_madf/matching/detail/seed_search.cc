// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/matching/detail/seed_search.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "vdb_madf/base/detail/parallel.h"

namespace vdb_madf::detail {

namespace {

constexpr size_t kSeeds = 12, kGuessed = 300, kBlock = 512;
constexpr size_t kCorners = 10, kCandidates = 18, kTested = 14;
constexpr double kNear = 0.35;  // spacings
constexpr size_t kLeastPairs = 7;
constexpr double kCertain = 0.65;  // of the farther neighbors
/// Neighbors that are looked for, how far from where, and the share of them to be found: farther
/// ones need not be in the scan. Chance may find as many; then little grows from there.
struct Stage {
  size_t neighbors;
  double near, share;
};
constexpr Stage kStages[] = {{kTested, kNear, 0.7},
                             {kAround, kNear, 0.6},
                             {2 * kAround, 0.3, 0.4},
                             {2 * kAround, 0.25, 0.4}};

/// Distances from the middle, the mean square being one.
std::vector<double> depthsOf(const ScanGrains& scan) {
  const double count = double(scan.bodies.size());
  Vec3d middle(0, 0, 0);
  for (const size_t n : scan.bodies) middle += scan.center(n) / count;
  double squares = 0;
  for (const size_t n : scan.bodies) squares += (scan.center(n) - middle).lengthSqr();
  const double unit = squares > 0 ? std::sqrt(squares / count) : 1;
  std::vector<double> depths;
  for (size_t n = 0; n < scan.size(); ++n)
    depths.push_back((scan.center(n) - middle).length() / unit);
  return depths;
}

/// The bodies of a scan, or the first of them, in the order of a key.
template <typename Key>
std::vector<size_t> sorted(const ScanGrains& scan, size_t most, const Key& key) {
  std::vector<std::pair<double, size_t>> items;
  for (const size_t n : scan.bodies) items.emplace_back(key(n), n);
  std::sort(items.begin(), items.end());
  std::vector<size_t> order;
  for (size_t k = 0; k < std::min(most, items.size()); ++k) order.push_back(items[k].second);
  return order;
}

}  // namespace

SeedSearch::SeedSearch(const ScanGrains& before, const ScanGrains& after,
                       const MatchOptions& options)
    : before_(before),
      after_(after),
      guess_(options.guess),
      depthsBefore_(depthsOf(before)),
      depthsAfter_(depthsOf(after)),
      inner_(sorted(before, before.size(), [&](size_t n) { return depthsBefore_[n]; })) {
  if (options.kind != MotionKind::rigid) return;
  shortest_ = 0.88;
  longest_ = 1.14;
}

size_t SeedSearch::count() const {
  return std::min(kSeeds, inner_.size());
}

std::optional<Seed> SeedSearch::operator()(size_t k, Interrupter* interrupter) const {
  const size_t n = inner_[k * std::max<size_t>(1, inner_.size() / (2 * kSeeds))];
  // Whole samples have their inner grains in common, and a guess is near.
  const std::vector<size_t> places =
      guess_ ? sorted(after_, kGuessed,
                      [&](size_t m) {
                        return ((*guess_)(before_.center(n)) - after_.center(m)).lengthSqr();
                      })
             : sorted(after_, after_.size(),
                      [&](size_t m) { return std::abs(depthsAfter_[m] - depthsBefore_[n]); });
  return bestOf(n, places, interrupter);
}

std::array<size_t, 3> SeedSearch::cornersOf(size_t n) const {
  const auto& around = before_.around[n];
  std::array<size_t, 3> best{kNoIndex, kNoIndex, kNoIndex};
  double most = 0;
  const size_t count = std::min(kCorners, around.size());
  const auto to = [&](size_t k) { return before_.center(around[k]) - before_.center(n); };
  for (size_t a = 0; a < count; ++a)
    for (size_t b = a + 1; b < count; ++b)
      for (size_t c = b + 1; c < count; ++c)
        if (const double volume = std::abs(to(a).cross(to(b)).dot(to(c))); volume > most) {
          most = volume;
          best = {around[a], around[b], around[c]};
        }
  return best;
}

std::optional<Seed> SeedSearch::bestOf(size_t n, const std::vector<size_t>& places,
                                       Interrupter* interrupter) const {
  const auto corners = cornersOf(n);
  if (corners[0] == kNoIndex) return std::nullopt;
  const std::vector<size_t> far = before_.aroundOf(n, 2 * kAround);
  std::optional<Seed> best;
  for (size_t first = 0; first < places.size(); first += kBlock) {
    std::vector<std::optional<Seed>> seeds(std::min(kBlock, places.size() - first));
    parallelForEach(seeds.size(), 16, interrupter,
                    [&](size_t k) { seeds[k] = at(n, corners, far, places[first + k]); });
    for (const auto& seed : seeds)
      if (seed && (!best || seed->score > best->score)) best = seed;
    // Chance does not find as many; fewer may be the right ones, where a scan ends.
    if (best && double(best->pairs.size()) >= kCertain * double(far.size() + 1)) break;
  }
  return best;
}

bool SeedSearch::alikeInLength(const Vec3d& a, const Vec3d& b) const {
  const double x = a.lengthSqr(), y = b.lengthSqr();
  return y >= shortest_ * shortest_ * x && y <= longest_ * longest_ * x;
}

std::optional<Seed> SeedSearch::at(size_t n, const std::array<size_t, 3>& corners,
                                   const std::vector<size_t>& far, size_t m) const {
  if (!alikeInVolume(before_.grains[n], after_.grains[m])) return std::nullopt;
  const Vec3d x = before_.center(n), y = after_.center(m);
  std::array<Vec3d, 3> v, w;
  std::array<std::vector<size_t>, 3> found;
  const auto& around = after_.around[m];
  for (size_t k = 0; k < 3; ++k) {
    v[k] = before_.center(corners[k]) - x;
    for (size_t c = 0; c < std::min(kCandidates, around.size()); ++c)
      if (alikeInLength(v[k], after_.center(around[c]) - y) &&
          alikeInVolume(before_.grains[corners[k]], after_.grains[around[c]]))
        found[k].push_back(around[c]);
  }
  const Mat3d edges(v[0], v[1], v[2], false);
  const Mat3d inverse = edges.inverse(0);
  std::optional<Seed> best;
  for (const size_t a : found[0])
    for (const size_t b : found[1]) {
      w[0] = after_.center(a) - y;
      w[1] = after_.center(b) - y;
      if (a == b || !alikeInLength(v[0] - v[1], w[0] - w[1])) continue;
      for (const size_t c : found[2]) {
        w[2] = after_.center(c) - y;
        if (c == a || c == b || !alikeInLength(v[0] - v[2], w[0] - w[2]) ||
            !alikeInLength(v[1] - v[2], w[1] - w[2]))
          continue;
        const Mat3d gradient = Mat3d(w[0], w[1], w[2], false) * inverse;
        if (!(gradient.det() > 0.4 && gradient.det() < 2)) continue;
        if (!looksRight(n, m, gradient)) continue;
        const auto seed =
            refined(n, far, {{n, m}, {corners[0], a}, {corners[1], b}, {corners[2], c}});
        if (seed && (!best || seed->score > best->score)) best = seed;
      }
    }
  return best;
}

size_t SeedSearch::near(size_t n, const Vec3d& place, double radius) const {
  std::pair<double, size_t> best{std::numeric_limits<double>::infinity(), kNoIndex};
  after_.cells.forEachWithin(place, radius, [&](size_t m, double squared) {
    if (alikeInVolume(before_.grains[n], after_.grains[m])) best = std::min(best, {squared, m});
  });
  return best.second;
}

bool SeedSearch::looksRight(size_t n, size_t m, const Mat3d& gradient) const {
  const auto& around = before_.around[n];
  const size_t tested = std::min(kTested, around.size());
  const size_t mayMiss = tested * 3 / 10;
  size_t misses = 0;
  for (size_t k = 0; k < tested; ++k) {
    const Vec3d place =
        after_.center(m) + gradient * (before_.center(around[k]) - before_.center(n));
    misses += near(around[k], place, kNear * before_.spacing[n]) == kNoIndex;
    if (misses > mayMiss) return false;
  }
  return true;
}

std::optional<Seed> SeedSearch::refined(size_t n, const std::vector<size_t>& far,
                                        Pairs pairs) const {
  Mat3d gradient = Mat3d::identity();
  double score = 0;
  for (const Stage& stage : kStages) {
    LocalFit fit;
    for (const auto& [a, b] : pairs) fit.add(before_.center(a), after_.center(b));
    const auto fitted = fit.gradient(Mat3d::identity(), 0);
    if (!fitted) return std::nullopt;
    gradient = *fitted;
    pairs.clear();
    score = 0;
    std::set<size_t> used;
    const size_t count = std::min(stage.neighbors, far.size());
    for (size_t k = 0; k <= count; ++k) {
      const size_t a = k == 0 ? n : far[k - 1];
      const Vec3d place = fit.meanY() + gradient * (before_.center(a) - fit.meanX());
      const double radius = stage.near * before_.spacing[n];
      const size_t b = near(a, place, radius);
      if (b == kNoIndex || !used.insert(b).second) continue;
      pairs.emplace_back(a, b);
      score += 1 - (after_.center(b) - place).lengthSqr() / (radius * radius);
    }
    if (pairs.size() < std::max(kLeastPairs, size_t(stage.share * double(count + 1))))
      return std::nullopt;
  }
  return Seed{pairs, gradient, score};
}

}  // namespace vdb_madf::detail
