// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/matching/match_grains.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "vdb_madf/base/detail/parallel.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/matching/detail/local_fit.h"
#include "vdb_madf/matching/detail/point_cells.h"

namespace vdb_madf {

namespace {

using detail::LocalFit;
using openvdb::Mat3d;
using openvdb::Vec3d;

constexpr size_t kNone = std::numeric_limits<size_t>::max();
constexpr size_t kAround = 24;     // neighbors of a grain: those in reach of about two spacings
constexpr int kFitted = 16;        // of them at most, the nearest that are followed
constexpr int kLeastFitted = 4;    // of them at least, to say where a grain is
constexpr int kLeastStrained = 6;  // and how they are strained
constexpr size_t kConfident = 12;  // neighbors that the confidence asks
constexpr double kLeastRatio = 0.6, kMostRatio = 1.6;  // of volumes
constexpr double kUnique = 1.6;                        // how much more anything else has to cost
constexpr double kLimit = 0.5;                         // farthest partner, in spacings
constexpr double kLeastLimit = 0.3;  // the same, where most are nearer: bonds that break let go
constexpr double kReach = kUnique * kLimit;
// What differs costs as much as a distance in spacings, squared, times these.
constexpr double kVolumeCost = 0.25, kMomentCost = 0.25, kContactCost = 0.1;
constexpr size_t kLeastSound = 7;   // grains that were followed
constexpr double kSound = 0.2;      // half of them miss their place by less, in spacings
constexpr size_t kGrainGrain = 64;  // grains per task
constexpr int kMaxSweeps = 400;

/// A scan's grains, and who is near whom.
struct Scan {
  const std::vector<GrainFeatures>& grains;
  detail::PointCells cells;
  std::vector<std::vector<size_t>> around, contacts;
  std::vector<double> spacing;  ///< mean distance of the nearest six

  Scan(const GrainSet& set, Interrupter* interrupter)
      : grains(set.grains),
        cells(centersOf(set.grains)),
        around(grains.size()),
        contacts(grains.size()),
        spacing(grains.size(), 1) {
    detail::parallelFor(size(), kGrainGrain, interrupter, [&](size_t begin, size_t end) {
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
      if (first == kNone || second == kNone) continue;
      contacts[first].push_back(second);
      contacts[second].push_back(first);
    }
    for (auto& touched : contacts) std::sort(touched.begin(), touched.end());
  }

  size_t size() const { return grains.size(); }
  const Vec3d& center(size_t n) const { return cells[n]; }
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
  static std::vector<Vec3d> centersOf(const std::vector<GrainFeatures>& grains) {
    std::vector<Vec3d> centers;
    for (const GrainFeatures& grain : grains) centers.push_back(grain.center);
    return centers;
  }
  size_t find(int32_t number) const {
    const auto found =
        std::lower_bound(grains.begin(), grains.end(), number,
                         [](const GrainFeatures& g, int32_t wanted) { return g.grain < wanted; });
    return found != grains.end() && found->grain == number ? size_t(found - grains.begin()) : kNone;
  }
};

bool alikeInVolume(const GrainFeatures& a, const GrainFeatures& b) {
  return b.volume >= kLeastRatio * a.volume && b.volume <= kMostRatio * a.volume;
}

Mat3d tensor(const std::array<double, 6>& t) {
  return {t[0], t[3], t[4], t[3], t[1], t[5], t[4], t[5], t[2]};
}

double median(std::vector<double> values) {
  const auto middle = values.begin() + std::ptrdiff_t(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

using Pairs = std::vector<std::pair<size_t, size_t>>;

/// Grains, and where they are found again.
struct Seed {
  Pairs pairs;
  Mat3d gradient;
};

/// Looks for a neighborhood of before in after.
class SeedSearch {
 public:
  SeedSearch(const Scan& before, const Scan& after, const MatchOptions& options)
      : before_(before),
        after_(after),
        guess_(options.guess),
        depthsBefore_(depthsOf(before)),
        depthsAfter_(depthsOf(after)),
        inner_(sorted(before.size(), before.size(), [&](size_t n) { return depthsBefore_[n]; })) {
    if (options.kind != MotionKind::rigid) return;
    shortest_ = 0.88;
    longest_ = 1.14;
  }

  /// Grains that are tried one after the other: the inner half, the innermost first.
  size_t count() const { return std::min(kSeeds, before_.size()); }

  std::optional<Seed> operator()(size_t k, Interrupter* interrupter) const {
    const size_t n = inner_[k * std::max<size_t>(1, inner_.size() / (2 * kSeeds))];
    // Whole samples have their inner grains in common, and a guess is near.
    const std::vector<size_t> places =
        guess_ ? sorted(after_.size(), kGuessed,
                        [&](size_t m) {
                          return ((*guess_)(before_.center(n)) - after_.center(m)).lengthSqr();
                        })
               : sorted(after_.size(), after_.size(),
                        [&](size_t m) { return std::abs(depthsAfter_[m] - depthsBefore_[n]); });
    return bestOf(n, places, interrupter);
  }

 private:
  static constexpr size_t kSeeds = 12, kGuessed = 300, kBlock = 512;
  static constexpr size_t kCorners = 10, kCandidates = 18, kTested = 14;
  static constexpr double kNear = 0.35;  // spacings
  static constexpr size_t kLeastPairs = 7;
  static constexpr double kCertain = 0.65;  // of the farther neighbors
  /// Neighbors that are looked for, how far from where, and the share of them to be found: farther
  /// ones need not be in the scan. Chance may find as many; then little grows from there.
  struct Stage {
    size_t neighbors;
    double near, share;
  };
  static constexpr Stage kStages[] = {{kTested, kNear, 0.7},
                                      {kAround, kNear, 0.6},
                                      {2 * kAround, 0.3, 0.4},
                                      {2 * kAround, 0.25, 0.4}};

  /// Distances from the middle, the mean square being one.
  static std::vector<double> depthsOf(const Scan& scan) {
    Vec3d middle(0, 0, 0);
    for (size_t n = 0; n < scan.size(); ++n) middle += scan.center(n) / double(scan.size());
    double squares = 0;
    for (size_t n = 0; n < scan.size(); ++n) squares += (scan.center(n) - middle).lengthSqr();
    const double unit = squares > 0 ? std::sqrt(squares / double(scan.size())) : 1;
    std::vector<double> depths;
    for (size_t n = 0; n < scan.size(); ++n)
      depths.push_back((scan.center(n) - middle).length() / unit);
    return depths;
  }

  /// The first of [0, count) in the order of a key.
  template <typename Key>
  static std::vector<size_t> sorted(size_t count, size_t most, const Key& key) {
    std::vector<std::pair<double, size_t>> items;
    for (size_t n = 0; n < count; ++n) items.emplace_back(key(n), n);
    std::sort(items.begin(), items.end());
    std::vector<size_t> order;
    for (size_t k = 0; k < std::min(most, count); ++k) order.push_back(items[k].second);
    return order;
  }

  /// Three neighbors that are far from one plane with the grain.
  std::array<size_t, 3> cornersOf(size_t n) const {
    const auto& around = before_.around[n];
    std::array<size_t, 3> best{kNone, kNone, kNone};
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

  std::optional<Seed> bestOf(size_t n, const std::vector<size_t>& places,
                             Interrupter* interrupter) const {
    const auto corners = cornersOf(n);
    if (corners[0] == kNone) return std::nullopt;
    const std::vector<size_t> far = before_.aroundOf(n, 2 * kAround);
    std::optional<Seed> best;
    for (size_t first = 0; first < places.size(); first += kBlock) {
      std::vector<std::optional<Seed>> seeds(std::min(kBlock, places.size() - first));
      detail::parallelFor(seeds.size(), 16, interrupter, [&](size_t begin, size_t end) {
        for (size_t k = begin; k < end; ++k) seeds[k] = at(n, corners, far, places[first + k]);
      });
      for (const auto& seed : seeds)
        if (seed && (!best || seed->pairs.size() > best->pairs.size())) best = seed;
      // Chance does not find as many; fewer may be the right ones, where a scan ends.
      if (best && double(best->pairs.size()) >= kCertain * double(far.size() + 1)) break;
    }
    return best;
  }

  bool alikeInLength(const Vec3d& a, const Vec3d& b) const {
    const double x = a.lengthSqr(), y = b.lengthSqr();
    return y >= shortest_ * shortest_ * x && y <= longest_ * longest_ * x;
  }

  /// All ways to find the three neighbors among those of a grain after.
  std::optional<Seed> at(size_t n, const std::array<size_t, 3>& corners,
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
          if (auto seed =
                  refined(n, far, {{n, m}, {corners[0], a}, {corners[1], b}, {corners[2], c}}))
            return seed;
        }
      }
    return std::nullopt;
  }

  /// The nearest grain after of such a volume.
  size_t near(size_t n, const Vec3d& place, double radius) const {
    std::pair<double, size_t> best{std::numeric_limits<double>::infinity(), kNone};
    after_.cells.forEachWithin(place, radius, [&](size_t m, double squared) {
      if (alikeInVolume(before_.grains[n], after_.grains[m])) best = std::min(best, {squared, m});
    });
    return best.second;
  }

  bool looksRight(size_t n, size_t m, const Mat3d& gradient) const {
    const auto& around = before_.around[n];
    const size_t tested = std::min(kTested, around.size());
    const size_t mayMiss = tested * 3 / 10;
    size_t misses = 0;
    for (size_t k = 0; k < tested; ++k) {
      const Vec3d place =
          after_.center(m) + gradient * (before_.center(around[k]) - before_.center(n));
      misses += near(around[k], place, kNear * before_.spacing[n]) == kNone;
      if (misses > mayMiss) return false;
    }
    return true;
  }

  std::optional<Seed> refined(size_t n, const std::vector<size_t>& far, Pairs pairs) const {
    Mat3d gradient = Mat3d::identity();
    for (const Stage& stage : kStages) {
      LocalFit fit;
      for (const auto& [a, b] : pairs) fit.add(before_.center(a), after_.center(b));
      const auto fitted = fit.gradient(Mat3d::identity(), 0);
      if (!fitted) return std::nullopt;
      gradient = *fitted;
      pairs.clear();
      std::set<size_t> used;
      const size_t count = std::min(stage.neighbors, far.size());
      for (size_t k = 0; k <= count; ++k) {
        const size_t a = k == 0 ? n : far[k - 1];
        const Vec3d place = fit.meanY() + gradient * (before_.center(a) - fit.meanX());
        const size_t b = near(a, place, stage.near * before_.spacing[n]);
        if (b != kNone && used.insert(b).second) pairs.emplace_back(a, b);
      }
      if (pairs.size() < std::max(kLeastPairs, size_t(stage.share * double(count + 1))))
        return std::nullopt;
    }
    return Seed{pairs, gradient};
  }

  const Scan &before_, &after_;
  std::optional<Motion> guess_;
  std::vector<double> depthsBefore_, depthsAfter_;
  std::vector<size_t> inner_;
  double shortest_ = 0.7, longest_ = 1.32;  // edges, of what they were: a fifth, and noise
};

/// Follows grains from what is known already.
class Following {
 public:
  Following(const Scan& before, const Scan& after)
      : before_(before),
        after_(after),
        partners_(before.size(), kNone),
        changed_(before.size(), 1),
        expected_(before.size()) {}

  void take(const Seed& seed) {
    for (const auto& [n, m] : seed.pairs) {
      partners_[n] = m;
      expected_[n].gradient = seed.gradient;
    }
  }

  void setWhole(const Motion& whole) {
    whole_ = whole;
    std::fill(changed_.begin(), changed_.end(), 1);
  }

  /// Until nothing changes. Grains are looked at again where a neighbor has changed.
  void settle(Interrupter* interrupter) {
    for (int sweep = 0; sweep < kMaxSweeps; ++sweep) {
      expectAll(interrupter);
      if (!match()) break;
    }
  }

  /// Whether what has grown is more than chance: most of the grains whose neighbors say that they
  /// lie among those of after are there, and close to where they say.
  bool isSound() const {
    openvdb::BBoxd box;
    for (size_t m = 0; m < after_.size(); ++m) box.expand(after_.center(m));
    size_t inside = 0;
    std::vector<double> misses;
    for (size_t n = 0; n < before_.size(); ++n) {
      inside += expected_[n].isPlaced && box.isInside(expected_[n].place);
      if (partners_[n] != kNone) misses.push_back(missOf(n) / before_.spacing[n]);
    }
    return misses.size() >= kLeastSound && 2 * misses.size() >= inside && median(misses) <= kSound;
  }

  /// All are looked at again, with an eye on how far the partners of most are.
  void finish(Interrupter* interrupter) {
    std::vector<double> misses;
    for (size_t n = 0; n < before_.size(); ++n)
      if (partners_[n] != kNone) misses.push_back(missOf(n) / before_.spacing[n]);
    if (misses.empty()) return;
    limit_ = std::clamp(4 * median(misses), kLeastLimit, kLimit);
    for (int sweep = 0; sweep < 3; ++sweep) {
      std::fill(changed_.begin(), changed_.end(), 1);
      expectAll(interrupter);
      match();
    }
  }

  /// The motion of most, by least squares without those that are far off.
  std::optional<Motion> wholeOf(MotionKind kind) const {
    Motion motion;
    double most = std::numeric_limits<double>::infinity();
    for (int round = 0; round < 5; ++round) {
      LocalFit fit;
      for (size_t n = 0; n < before_.size(); ++n)
        if (partners_[n] != kNone && (round == 0 || missOf(n, motion) <= most))
          fit.add(before_.center(n), after_.center(partners_[n]));
      if (fit.count() < kLeastFitted) return std::nullopt;
      const auto gradient = fit.gradient(Mat3d::identity(), 0);
      if (!gradient) return std::nullopt;
      motion.linear = kind == MotionKind::rigid ? detail::turnOf(*gradient) : *gradient;
      motion.shift = fit.meanY() - motion.linear * fit.meanX();
      std::vector<double> misses;
      for (size_t n = 0; n < before_.size(); ++n)
        if (partners_[n] != kNone) misses.push_back(missOf(n, motion));
      most = 3 * median(misses);
    }
    return motion;
  }

  FollowedGrains result() const {
    FollowedGrains matches;
    matches.whole = whole_;
    matches.grains.resize(before_.size());
    for (size_t n = 0; n < before_.size(); ++n) {
      FollowedGrain& match = matches.grains[n];
      match.isPlaced = expected_[n].isPlaced;
      match.place = expected_[n].place;
      if (partners_[n] == kNone) continue;
      ++matches.count;
      match.partner = after_.grains[partners_[n]].grain;
      match.miss = missOf(n);
      LocalFit fit;
      fit.add(before_.center(n), after_.center(partners_[n]));
      size_t near = 0;
      for (size_t k = 0; k < before_.around[n].size(); ++k) {
        const size_t other = before_.around[n][k];
        if (partners_[other] == kNone) continue;
        near += k < kConfident;
        if (fit.count() <= int(kConfident))
          fit.add(before_.center(other), after_.center(partners_[other]));
      }
      match.neighbors = fit.count() - 1;
      if (match.neighbors >= kLeastStrained) match.gradient = fit.gradient(Mat3d::identity(), 0);
      match.confidence = (1 - ratios_[n]) * std::min(1., double(near) / (kConfident * 2. / 3));
    }
    return matches;
  }

 private:
  struct Candidate {
    size_t grain;
    double cost, distance;
  };
  /// Where a grain should be, and what is there.
  struct Expected {
    bool isPlaced = false;
    Vec3d place{0, 0, 0};
    Mat3d gradient = Mat3d::identity();
    std::vector<Candidate> candidates;
  };

  double missOf(size_t n) const {
    return (after_.center(partners_[n]) - expected_[n].place).length();
  }
  double missOf(size_t n, const Motion& motion) const {
    return (after_.center(partners_[n]) - motion(before_.center(n))).length();
  }

  void expectAll(Interrupter* interrupter) {
    std::vector<Expected> next(before_.size());
    std::vector<char> isNew(before_.size(), 0);
    detail::parallelFor(before_.size(), kGrainGrain, interrupter, [&](size_t begin, size_t end) {
      for (size_t n = begin; n < end; ++n) {
        const auto& around = before_.around[n];
        isNew[n] = changed_[n] || std::any_of(around.begin(), around.end(),
                                              [&](size_t other) { return changed_[other]; });
        if (isNew[n]) next[n] = expect(n);
      }
    });
    for (size_t n = 0; n < before_.size(); ++n)
      if (isNew[n]) expected_[n] = std::move(next[n]);
  }

  Expected expect(size_t n) const {
    Expected here;
    std::vector<size_t> followed;
    Mat3d near = Mat3d::zero();
    for (const size_t other : before_.around[n])
      if (partners_[other] != kNone && int(followed.size()) < kFitted) {
        followed.push_back(other);
        near += expected_[other].gradient;
      }
    if (int(followed.size()) >= kLeastFitted) {
      near *= 1. / double(followed.size());
      double most = std::numeric_limits<double>::infinity();
      std::vector<double> misses(followed.size(), 0);
      for (int round = 0; round < 2; ++round) {  // the second without those that are far off
        LocalFit fit;
        for (size_t k = 0; k < followed.size(); ++k)
          if (misses[k] <= most)
            fit.add(before_.center(followed[k]), after_.center(partners_[followed[k]]));
        const auto gradient = fit.gradient(near, before_.spacing[n] * before_.spacing[n]);
        here.gradient = gradient ? *gradient : near;
        const auto place = [&](size_t of) {
          return fit.meanY() + here.gradient * (before_.center(of) - fit.meanX());
        };
        here.place = place(n);
        for (size_t k = 0; k < followed.size(); ++k)
          misses[k] = (after_.center(partners_[followed[k]]) - place(followed[k])).length();
        most = 3 * median(misses);
      }
    } else if (whole_) {
      here.gradient = whole_->linear;
      here.place = (*whole_)(before_.center(n));
    } else {
      return here;
    }
    here.isPlaced = true;
    addCandidates(n, here);
    return here;
  }

  void addCandidates(size_t n, Expected& here) const {
    const GrainFeatures& grain = before_.grains[n];
    const double spacing = before_.spacing[n];
    const Mat3d turn = detail::turnOf(here.gradient);
    const Mat3d moments = turn * tensor(grain.moments) * turn.transpose();
    const double size = std::max(detail::trace(moments), 1e-300);
    after_.cells.forEachWithin(here.place, kReach * spacing, [&](size_t m, double squared) {
      const GrainFeatures& other = after_.grains[m];
      if (!alikeInVolume(grain, other)) return;
      const double distance = std::sqrt(squared) / spacing,
                   volume = std::log(other.volume / grain.volume);
      double cost = distance * distance + kVolumeCost * volume * volume;
      const double otherSize = std::max(detail::trace(tensor(other.moments)), 1e-300);
      cost += kMomentCost *
              detail::squaredNorm(moments * (1 / size) - tensor(other.moments) * (1 / otherSize));
      const double apart = 1 - contactsKept(n, m);
      cost += kContactCost * apart * apart;
      here.candidates.push_back({m, std::sqrt(cost), distance});
    });
    std::sort(here.candidates.begin(), here.candidates.end(),
              [](const Candidate& a, const Candidate& b) {
                return std::pair(a.cost, a.grain) < std::pair(b.cost, b.grain);
              });
  }

  /// Of the followed grains that touch one, those that touch its partner; 1: there are none.
  double contactsKept(size_t n, size_t m) const {
    int all = 0, kept = 0;
    for (const size_t other : before_.contacts[n]) {
      if (partners_[other] == kNone) continue;
      ++all;
      kept += after_.touch(m, partners_[other]);
    }
    return all == 0 ? 1 : double(kept) / all;
  }

  /// @return whether anything has changed
  bool match() {
    struct Claim {
      size_t grain = kNone;
      double cost = kReach, second = kReach;
    };
    std::vector<Claim> claims(after_.size());
    for (size_t n = 0; n < before_.size(); ++n)
      for (const Candidate& candidate : expected_[n].candidates) {
        Claim& claim = claims[candidate.grain];
        if (claim.grain == kNone || candidate.cost < claim.cost) {
          if (claim.grain != kNone) claim.second = std::min(claim.second, claim.cost);
          claim.cost = candidate.cost;
          claim.grain = n;
        } else {
          claim.second = std::min(claim.second, candidate.cost);
        }
      }
    std::vector<size_t> partners(before_.size(), kNone);
    ratios_.assign(before_.size(), 1);
    for (size_t n = 0; n < before_.size(); ++n) {
      const auto& candidates = expected_[n].candidates;
      if (candidates.empty() || candidates[0].distance > limit_) continue;
      const Claim& claim = claims[candidates[0].grain];
      if (claim.grain != n) continue;
      double second = std::max(claim.second, candidates[0].cost);
      if (candidates.size() > 1) second = std::min(second, candidates[1].cost);
      ratios_[n] = second > 0 ? candidates[0].cost / second : 0;
      if (ratios_[n] * kUnique <= 1) partners[n] = candidates[0].grain;
    }
    bool any = false;
    for (size_t n = 0; n < before_.size(); ++n) {
      changed_[n] = partners[n] != partners_[n];
      any = any || changed_[n];
    }
    partners_ = std::move(partners);
    return any;
  }

  const Scan &before_, &after_;
  std::vector<size_t> partners_;
  std::vector<char> changed_;
  std::vector<Expected> expected_;
  std::vector<double> ratios_;
  std::optional<Motion> whole_;
  double limit_ = kLimit;
};

void check(const GrainSet& set) {
  int64_t last = std::numeric_limits<int64_t>::min();
  for (const GrainFeatures& grain : set.grains) {
    if (grain.grain <= last) throw InvalidInput("the numbers of grains have to ascend");
    last = grain.grain;
    bool isFine = std::isfinite(grain.volume) && grain.volume > 0;
    for (int axis = 0; axis < 3; ++axis) isFine = isFine && std::isfinite(grain.center[axis]);
    for (const double moment : grain.moments) isFine = isFine && std::isfinite(moment);
    if (!isFine)
      throw InvalidInput("grain " + std::to_string(grain.grain) +
                         " has no finite center, volume and moments");
  }
}

}  // namespace

std::optional<FollowedGrains> matchGrains(const GrainSet& before, const GrainSet& after,
                                          const MatchOptions& options, Interrupter* interrupter) {
  check(before);
  check(after);
  const Scan first(before, interrupter), second(after, interrupter);
  const SeedSearch search(first, second, options);
  std::optional<Following> following;
  bool isSound = false;
  for (size_t k = 0; k < search.count() && !isSound; ++k) {
    const auto seed = search(k, interrupter);
    if (!seed) continue;
    following.emplace(first, second);
    following->take(*seed);
    following->settle(interrupter);
    isSound = following->isSound();
  }
  if (!isSound) {
    if (!options.guess) return std::nullopt;
    following.emplace(first, second);
    following->setWhole(*options.guess);
    following->settle(interrupter);
  }
  if (options.kind != MotionKind::free)
    if (const auto whole = following->wholeOf(options.kind)) {
      following->setWhole(*whole);
      following->settle(interrupter);
    }
  following->finish(interrupter);
  return following->result();
}

Strain strainOf(const Mat3d& gradient) {
  Strain strain;
  const Mat3d green = (gradient.transpose() * gradient - Mat3d::identity()) * 0.5;
  strain.volumetric = detail::trace(green);
  const Mat3d rest = green - Mat3d::identity() * (strain.volumetric / 3);
  strain.deviatoric = std::sqrt(2. / 3 * detail::squaredNorm(rest));
  const Mat3d turn = detail::turnOf(gradient);
  // The antisymmetric part has the sine of the angle, the trace its cosine.
  const Vec3d sine =
      Vec3d(turn(2, 1) - turn(1, 2), turn(0, 2) - turn(2, 0), turn(1, 0) - turn(0, 1)) * 0.5;
  const double length = sine.length(), cosine = (detail::trace(turn) - 1) / 2;
  if (length > 0)
    strain.turn = sine * (std::atan2(length, cosine) * (180 / 3.141592653589793) / length);
  return strain;
}

}  // namespace vdb_madf
