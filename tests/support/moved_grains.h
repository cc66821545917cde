// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

// Grains before and after a known motion, as their features.

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <random>
#include <string>

#include "vdb_madf/matching/detail/local_fit.h"
#include "vdb_madf/matching/detail/point_cells.h"
#include "vdb_madf/matching/match_grains.h"

namespace vdb_madf::test {

/// How grains look and move.
struct MovedGrainsOptions {
  std::string kind = "balls";  ///< of equal size; or ellipsoids, sand, snow
  size_t count = 500;
  double strain = 0.16;   ///< shortening along z; a quarter of it is gained along x and y
  double degrees = 10;    ///< of a turn about (1, 2, 2)
  double shear = 0.05;    ///< of x along z
  double noise = 0.05;    ///< standard deviation of each coordinate after, in mean diameters
  double changed = 0.03;  ///< share of grains that are there before alone, and after alone
  double wave = 0;        ///< mean radii that grains move besides, in waves of 20 diameters
  unsigned seed = 1;
};

/// Both scans, and the numbers that belong together.
struct MovedGrains {
  GrainSet before, after;
  std::map<int32_t, int32_t> partners;
  Motion motion;
};

class Dice {
 public:
  explicit Dice(unsigned seed) : random_(seed) {}
  double uniform() { return double(random_()) / 4294967296.; }
  double normal() {
    return std::sqrt(-2 * std::log(1 - uniform())) * std::cos(6.283185307179586 * uniform());
  }
  openvdb::Vec3d vector() {
    const double x = normal(), y = normal();
    return {x, y, normal()};
  }
  size_t below(size_t count) { return size_t(uniform() * double(count)); }

 private:
  std::mt19937 random_;
};

inline openvdb::Mat3d turnAbout(const openvdb::Vec3d& axis, double degrees) {
  // OpenVDB's is for rows.
  return openvdb::math::rotation<openvdb::Mat3d>(axis.unit(), degrees * 3.141592653589793 / 180)
      .transpose();
}

/// Places in a cube, pushed apart until grains of these radii hardly overlap; about 0.6 solid.
inline std::vector<openvdb::Vec3d> packed(const std::vector<double>& radii, Dice& dice) {
  double solid = 0;
  for (const double r : radii) solid += 4.18879 * r * r * r;
  const double side = std::cbrt(solid / 0.6), most = *std::max_element(radii.begin(), radii.end());
  std::vector<openvdb::Vec3d> places;
  for (size_t n = 0; n < radii.size(); ++n) {
    const double x = dice.uniform(), y = dice.uniform();
    places.push_back(openvdb::Vec3d(x, y, dice.uniform()) * side);
  }
  for (int round = 0; round < 40; ++round) {
    const detail::PointCells cells(places);
    for (size_t n = 0; n < places.size(); ++n) {
      openvdb::Vec3d push(0, 0, 0);
      cells.forEachWithin(cells[n], radii[n] + most, [&](size_t m, double squared) {
        const double away = std::sqrt(squared), least = radii[n] + radii[m];
        if (m != n && away > 0 && away < least)
          push += (cells[n] - cells[m]) * (0.4 * (least - away) / away);
      });
      for (int axis = 0; axis < 3; ++axis)
        places[n][axis] = std::clamp(places[n][axis] + push[axis], 0., side);
    }
  }
  return places;
}

inline std::array<double, 6> momentsOf(const openvdb::Mat3d& turn, const openvdb::Vec3d& axes) {
  openvdb::Mat3d m = openvdb::Mat3d::zero();
  for (int k = 0; k < 3; ++k) m(k, k) = axes[k] * axes[k] / 5;
  m = turn * m * turn.transpose();
  return {m(0, 0), m(1, 1), m(2, 2), m(0, 1), m(0, 2), m(1, 2)};
}

inline MovedGrains movedGrains(const MovedGrainsOptions& options) {
  Dice dice(options.seed);
  const bool isBall = options.kind == "balls", isSnow = options.kind == "snow";
  const double spread = isBall ? 0 : options.kind == "ellipsoids" ? 0.1 : isSnow ? 0.35 : 0.2;
  const double volumeNoise = isBall ? 0.02 : isSnow ? 0.1 : 0.04;
  std::vector<double> radii;
  for (size_t n = 0; n < options.count; ++n)
    radii.push_back(8 * std::exp(spread * std::clamp(dice.normal(), -2.5, 2.5)));
  const std::vector<openvdb::Vec3d> places = packed(radii, dice);
  const double radius = std::accumulate(radii.begin(), radii.end(), 0.) / double(radii.size());

  MovedGrains moved;
  openvdb::Mat3d stretch = openvdb::Mat3d::identity();
  stretch(0, 0) = stretch(1, 1) = 1 + options.strain / 4;
  stretch(2, 2) = 1 - options.strain;
  stretch(0, 2) = options.shear;
  const openvdb::Mat3d turn = turnAbout({1, 2, 2}, options.degrees);
  moved.motion.linear = turn * stretch;
  moved.motion.shift = {41.3, -17.7, 23.9};

  std::vector<int32_t> numbers(options.count);
  std::iota(numbers.begin(), numbers.end(), 1);
  for (size_t n = numbers.size(); n > 1; --n) std::swap(numbers[n - 1], numbers[dice.below(n)]);
  for (size_t n = 0; n < options.count; ++n) {
    const double r = radii[n], volume = 4.18879 * r * r * r;
    openvdb::Vec3d axes(r, r, r);
    if (!isBall) {
      const double a = 1 + 0.5 * dice.uniform(), c = 1 - 0.3 * dice.uniform();
      axes = openvdb::Vec3d(a, 1 / (a * c), c) * r;
    }
    const openvdb::Vec3d first = dice.vector(), second = dice.vector(), drift = dice.vector();
    const double angle = 360 * dice.uniform(), own = 5 * dice.normal();
    const openvdb::Mat3d pose = turnAbout(first, angle);
    const int32_t number = int32_t(n) + 1, later = numbers[n];
    const double place = dice.uniform();
    const bool isBefore = place >= options.changed, isAfter = place < 1 - options.changed;
    if (isBefore) moved.before.grains.push_back({number, places[n], volume, momentsOf(pose, axes)});
    const double wave = 6.283185307179586 / (40 * radius);
    const openvdb::Vec3d waves(std::sin(wave * places[n][1]), std::sin(wave * places[n][2]),
                               std::sin(wave * places[n][0]));
    const openvdb::Vec3d there = moved.motion(places[n] + waves * (options.wave * radius)) +
                                 drift * (options.noise * 2 * radius);
    const double grown = std::max(0.3, 1 + volumeNoise * dice.normal());
    if (isAfter)
      moved.after.grains.push_back(
          {later, there, volume * grown, momentsOf(turnAbout(second, own) * turn * pose, axes)});
    if (isBefore && isAfter) moved.partners[number] = later;
  }
  std::sort(moved.after.grains.begin(), moved.after.grains.end(),
            [](const GrainFeatures& a, const GrainFeatures& b) { return a.grain < b.grain; });
  return moved;
}

/// What a matching is worth: grains that are in both scans, and of them those that are rightly
/// followed; wrongly followed ones, of all.
struct MatchScore {
  int64_t all = 0, right = 0, wrong = 0;
};

inline MatchScore scoreOf(const MovedGrains& moved, const FollowedGrains& matches) {
  MatchScore score;
  score.all = int64_t(moved.partners.size());
  for (size_t n = 0; n < matches.grains.size(); ++n) {
    if (matches.grains[n].partner == 0) continue;
    const auto truth = moved.partners.find(moved.before.grains[n].grain);
    const bool isRight =
        truth != moved.partners.end() && truth->second == matches.grains[n].partner;
    ++(isRight ? score.right : score.wrong);
  }
  return score;
}

}  // namespace vdb_madf::test
