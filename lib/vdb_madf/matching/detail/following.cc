// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/matching/detail/following.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "vdb_madf/base/detail/median.h"
#include "vdb_madf/base/detail/parallel.h"

namespace vdb_madf::detail {

namespace {

constexpr int kFitted = 16;        // neighbors at most, the nearest that are followed
constexpr int kLeastFitted = 4;    // of them at least, to say where a grain is
constexpr int kLeastStrained = 6;  // and how they are strained
constexpr size_t kConfident = 12;  // neighbors that the confidence asks
constexpr double kUnique = 1.6;    // how much more anything else has to cost
constexpr double kLeastLimit =
    0.3;  // farthest partner where most are nearer: bonds that break let go
constexpr double kReach = kUnique * Following::kLimit;
// What differs costs as much as a distance in spacings, squared, times these.
constexpr double kVolumeCost = 0.25, kMomentCost = 0.25, kContactCost = 0.1;
constexpr size_t kLeastSound = 7;  // grains that were followed
constexpr double kSound = 0.2;     // half of them miss their place by less, in spacings
constexpr int kMaxSweeps = 400;

/// That a match is right, of a score from 0 to 1: fitted to moved packs.
double confidence(double score) {
  const double rest = 1 - score, squared = rest * rest;
  return 1 - 0.12 * squared * squared * rest;
}

Mat3d tensor(const std::array<double, 6>& t) {
  return {t[0], t[3], t[4], t[3], t[1], t[5], t[4], t[5], t[2]};
}

}  // namespace

void Following::settle(Interrupter* interrupter) {
  for (int sweep = 0; sweep < kMaxSweeps; ++sweep) {
    expectDue(interrupter);
    if (!match()) break;
  }
}

bool Following::areFound(bool specks) const {
  openvdb::BBoxd box;
  for (size_t m = 0; m < after_.size(); ++m) box.expand(after_.center(m));
  size_t inside = 0, followed = 0;
  for (size_t n = 0; n < before_.size(); ++n) {
    if (bool(before_.isSpeck[n]) != specks) continue;
    inside += expected_[n].isPlaced && box.isInside(expected_[n].place);
    followed += partners_[n] != kNoIndex;
  }
  return 2 * followed >= inside;
}

bool Following::isSound() const {
  const std::vector<double> all = misses();
  return all.size() >= kLeastSound && areFound(false) && upperMedian(all) <= kSound;
}

void Following::finish(Interrupter* interrupter) {
  const std::vector<double> all = misses();
  if (all.empty()) return;
  limit_ = std::clamp(4 * upperMedian(all), kLeastLimit, kLimit);
  for (int sweep = 0; sweep < 3; ++sweep) {
    changeAll();
    expectDue(interrupter);
    match();
  }
  if (areFound(true)) return;
  for (size_t n = 0; n < before_.size(); ++n)
    if (before_.isSpeck[n]) partners_[n] = kNoIndex;
}

std::vector<double> Following::misses() const {
  std::vector<double> all;
  for (const size_t n : before_.bodies)
    if (partners_[n] != kNoIndex) all.push_back(missOf(n) / before_.spacing[n]);
  return all;
}

std::optional<Motion> Following::wholeOf(MotionKind kind) const {
  std::vector<size_t> followed, whole;
  for (const size_t n : before_.bodies) {
    if (partners_[n] == kNoIndex) continue;
    followed.push_back(n);
    if (!isCut(n)) whole.push_back(n);
  }
  if (int(whole.size()) >= kLeastFitted) followed.swap(whole);
  Motion motion;
  double most = std::numeric_limits<double>::infinity();
  for (int round = 0; round < 5; ++round) {
    LocalFit fit;
    for (const size_t n : followed)
      if (round == 0 || missOf(n, motion) <= most)
        fit.add(before_.center(n), after_.center(partners_[n]));
    if (fit.count() < kLeastFitted) return std::nullopt;
    const auto gradient = fit.gradient(Mat3d::identity(), 0);
    if (!gradient) return std::nullopt;
    motion.linear = kind == MotionKind::rigid ? turnOf(*gradient) : *gradient;
    motion.shift = fit.meanY() - motion.linear * fit.meanX();
    std::vector<double> misses;
    for (const size_t n : followed) misses.push_back(missOf(n, motion));
    most = 3 * upperMedian(misses);
  }
  return motion;
}

FollowedGrains Following::result() const {
  FollowedGrains matches;
  matches.whole = whole_;
  matches.grains.resize(before_.size());
  for (size_t n = 0; n < before_.size(); ++n) {
    FollowedGrain& match = matches.grains[n];
    match.isPlaced = expected_[n].isPlaced;
    match.place = expected_[n].place;
    match.nearby = expected_[n].gradient;
    if (partners_[n] == kNoIndex) continue;
    ++matches.count;
    match.partner = after_.grains[partners_[n]].grain;
    match.isCut = isCut(n);
    LocalFit fit;
    if (!match.isCut) fit.add(before_.center(n), after_.center(partners_[n]));
    const int own = fit.count();
    size_t near = 0;
    for (size_t k = 0; k < before_.around[n].size(); ++k) {
      const size_t other = before_.around[n][k];
      if (partners_[other] == kNoIndex) continue;
      near += k < kConfident;
      if (fit.count() - own < int(kConfident) && !isCut(other))
        fit.add(before_.center(other), after_.center(partners_[other]));
    }
    match.neighbors = fit.count() - own;
    if (match.neighbors >= kLeastStrained) match.gradient = fit.gradient(Mat3d::identity(), 0);
    if (match.isCut && match.gradient)
      match.place = fit.meanY() + *match.gradient * (before_.center(n) - fit.meanX());
    match.miss = (after_.center(partners_[n]) - match.place).length();
    match.confidence =
        confidence((1 - ratios_[n]) * std::min(1., double(near) / (kConfident * 2. / 3)));
  }
  return matches;
}

Following::Dependents::Dependents(const std::vector<std::vector<size_t>>& around)
    : first(around.size() + 1, 0) {
  for (const auto& near : around)
    for (const size_t n : near) ++first[n + 1];
  for (size_t n = 0; n < around.size(); ++n) first[n + 1] += first[n];
  grains.resize(first.back());
  std::vector<size_t> next(first.begin(), first.end() - 1);
  for (size_t n = 0; n < around.size(); ++n)
    for (const size_t other : around[n]) grains[next[other]++] = uint32_t(n);
}

std::vector<size_t> Following::due() {
  std::vector<size_t> due;
  const auto add = [&](size_t n) {
    if (isDue_[n]) return;
    isDue_[n] = 1;
    due.push_back(n);
  };
  for (const size_t n : changed_) {
    add(n);
    for (size_t k = dependents_.first[n]; k < dependents_.first[n + 1]; ++k)
      add(dependents_.grains[k]);
  }
  for (const size_t n : due) isDue_[n] = 0;
  return due;
}

void Following::expectDue(Interrupter* interrupter) {
  const std::vector<size_t> grains = due();
  std::vector<Expected> next(grains.size());
  parallelForEach(grains.size(), kGrainsPerTask, interrupter,
                  [&](size_t k) { next[k] = expect(grains[k]); });
  for (size_t k = 0; k < grains.size(); ++k) expected_[grains[k]] = std::move(next[k]);
}

Following::Expected Following::expect(size_t n) const {
  Expected here;
  std::vector<size_t> followed;
  Mat3d near = Mat3d::zero();
  for (const size_t other : before_.around[n])
    if (partners_[other] != kNoIndex && int(followed.size()) < kFitted) {
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
      most = 3 * upperMedian(misses);
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

void Following::addCandidates(size_t n, Expected& here) const {
  const GrainFeatures& grain = before_.grains[n];
  const double spacing = before_.spacing[n];
  const Mat3d turn = turnOf(here.gradient);
  const Mat3d moments = turn * tensor(grain.moments) * turn.transpose();
  const double size = std::max(trace(moments), 1e-300);
  after_.cells.forEachWithin(here.place, kReach * spacing, [&](size_t m, double squared) {
    const GrainFeatures& other = after_.grains[m];
    if (!alikeInVolume(grain, other)) return;
    const double distance = std::sqrt(squared) / spacing,
                 volume = std::log(other.volume / grain.volume);
    double cost = distance * distance + kVolumeCost * volume * volume;
    const double otherSize = std::max(trace(tensor(other.moments)), 1e-300);
    cost +=
        kMomentCost * squaredNorm(moments * (1 / size) - tensor(other.moments) * (1 / otherSize));
    const double apart = 1 - contactsKept(n, m);
    cost += kContactCost * apart * apart;
    here.candidates.push_back({m, std::sqrt(cost), distance});
  });
  std::sort(here.candidates.begin(), here.candidates.end(),
            [](const Candidate& a, const Candidate& b) {
              return std::pair(a.cost, a.grain) < std::pair(b.cost, b.grain);
            });
}

double Following::contactsKept(size_t n, size_t m) const {
  int all = 0, kept = 0;
  for (const size_t other : before_.contacts[n]) {
    if (partners_[other] == kNoIndex) continue;
    ++all;
    kept += after_.touch(m, partners_[other]);
  }
  return all == 0 ? 1 : double(kept) / all;
}

bool Following::match() {
  claims_.assign(after_.size(), {kNoIndex, kReach, kReach});
  for (size_t n = 0; n < before_.size(); ++n)
    for (const Candidate& candidate : expected_[n].candidates) {
      Claim& claim = claims_[candidate.grain];
      if (claim.grain == kNoIndex || candidate.cost < claim.cost) {
        if (claim.grain != kNoIndex) claim.second = std::min(claim.second, claim.cost);
        claim.cost = candidate.cost;
        claim.grain = n;
      } else {
        claim.second = std::min(claim.second, candidate.cost);
      }
    }
  ratios_.assign(before_.size(), 1);
  changed_.clear();
  for (size_t n = 0; n < before_.size(); ++n) {
    const size_t partner = partnerOf(n);
    if (partner != partners_[n]) changed_.push_back(n);
    partners_[n] = partner;
  }
  return !changed_.empty();
}

size_t Following::partnerOf(size_t n) {
  const auto& candidates = expected_[n].candidates;
  if (candidates.empty() || candidates[0].distance > limit_) return kNoIndex;
  const Claim& claim = claims_[candidates[0].grain];
  if (claim.grain != n) return kNoIndex;
  double second = std::max(claim.second, candidates[0].cost);
  if (candidates.size() > 1) second = std::min(second, candidates[1].cost);
  ratios_[n] = second > 0 ? candidates[0].cost / second : 0;
  return ratios_[n] * kUnique <= 1 ? candidates[0].grain : kNoIndex;
}

}  // namespace vdb_madf::detail
