// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/matching/match_grains.h"

#include <cmath>
#include <functional>
#include <limits>

#include "support/catch.h"
#include "support/moved_grains.h"
#include "support/runs.h"
#include "vdb_madf/base/errors.h"

using namespace vdb_madf;
using namespace vdb_madf::test;

namespace {

double share(int64_t part, int64_t whole) {
  return double(part) / double(whole);
}

/// The largest difference of two matrices.
double apart(const openvdb::Mat3d& a, const openvdb::Mat3d& b) {
  double most = 0;
  for (int n = 0; n < 9; ++n) most = std::max(most, std::abs(a.asPointer()[n] - b.asPointer()[n]));
  return most;
}

}  // namespace

TEST_CASE("match_grains: grains are followed through strain, turns and noise", "[match_grains]") {
  for (const char* kind : {"balls", "ellipsoids", "sand", "snow"})
    for (const MotionKind motion : {MotionKind::affine, MotionKind::free})
      for (const unsigned seed : {1u, 2u}) {
        CAPTURE(kind, int(motion), seed);
        MovedGrainsOptions options;
        options.kind = kind;
        options.seed = seed;
        if (seed == 2) {
          options.strain = 0.2;
          options.degrees = 30;
        }
        const MovedGrains moved = movedGrains(options);
        const auto matches = matchGrains(moved.before, moved.after, {motion, {}});
        REQUIRE(matches);
        const MatchScore score = scoreOf(moved, *matches);
        CHECK(share(score.right, score.all) >= 0.99);
        CHECK(share(score.wrong, score.all) < 0.001);
        CHECK(score.right + score.wrong == matches->count);
        REQUIRE(matches->whole.has_value() == (motion != MotionKind::free));
        if (matches->whole) CHECK(apart(matches->whole->linear, moved.motion.linear) < 0.01);
      }
}

TEST_CASE("match_grains: grains that are no longer there are lost", "[match_grains]") {
  MovedGrainsOptions options;
  options.changed = 0.2;
  const MovedGrains moved = movedGrains(options);
  const auto matches = matchGrains(moved.before, moved.after);
  REQUIRE(matches);
  const MatchScore score = scoreOf(moved, *matches);
  CHECK(share(score.right, score.all) >= 0.99);
  CHECK(share(score.wrong, score.all) < 0.005);
  // The doubtful ones are told by their confidence.
  double right = 0, wrong = 0;
  for (size_t n = 0; n < matches->grains.size(); ++n) {
    const FollowedGrain& match = matches->grains[n];
    CHECK((match.confidence >= 0 && match.confidence <= 1));
    if (!match.partner) continue;
    const auto truth = moved.partners.find(moved.before.grains[n].grain);
    (truth != moved.partners.end() && truth->second == match.partner ? right : wrong) +=
        match.confidence;
  }
  CHECK(right / double(score.right) > 0.7);
  if (score.wrong) CHECK(wrong / double(score.wrong) < right / double(score.right));
}

TEST_CASE("match_grains: what moves alike is known exactly", "[match_grains]") {
  MovedGrainsOptions options;
  options.kind = "sand";
  options.noise = options.changed = 0;
  for (const double shear : {0.05, 0.2}) {
    options.shear = shear;
    const MovedGrains moved = movedGrains(options);
    const auto matches = matchGrains(moved.before, moved.after);
    REQUIRE(matches);
    const Strain truth = strainOf(moved.motion.linear);
    CHECK(matches->count == int64_t(options.count));
    for (const FollowedGrain& match : matches->grains) {
      REQUIRE(match.gradient);
      REQUIRE(apart(*match.gradient, moved.motion.linear) < 1e-9);
      const Strain strain = strainOf(*match.gradient);
      REQUIRE(std::abs(strain.volumetric - truth.volumetric) < 1e-9);
      REQUIRE(std::abs(strain.deviatoric - truth.deviatoric) < 1e-9);
    }
  }
  options.strain = options.shear = 0;
  options.degrees = 25;
  const MovedGrains turned = movedGrains(options);
  const auto matches = matchGrains(turned.before, turned.after, {MotionKind::rigid, {}});
  REQUIRE(matches);
  CHECK(apart(matches->whole->linear, turned.motion.linear) < 1e-9);
  const Strain strain = strainOf(*matches->grains[7].gradient);
  CHECK(std::abs(strain.volumetric) < 1e-9);
  CHECK((strain.turn - openvdb::Vec3d(1, 2, 2) * (25. / 3)).length() < 1e-6);
}

TEST_CASE("match_grains: strains are those of their definition", "[match_grains]") {
  openvdb::Mat3d stretch = openvdb::Mat3d::identity();
  stretch(0, 0) = 1.2;
  stretch(1, 1) = 0.9;
  stretch(2, 2) = 0.8;
  const double e[3] = {0.22, -0.095, -0.18}, third = (e[0] + e[1] + e[2]) / 3;
  double squares = 0;
  for (const double value : e) squares += (value - third) * (value - third);
  for (const double degrees : {0., 90., 175.}) {
    const openvdb::Vec3d axis = openvdb::Vec3d(2, -1, 3).unit();
    const Strain strain = strainOf(turnAbout(axis, degrees) * stretch);
    CHECK(std::abs(strain.volumetric - 3 * third) < 1e-12);
    CHECK(std::abs(strain.deviatoric - std::sqrt(2. / 3 * squares)) < 1e-12);
    CHECK((strain.turn - axis * degrees).length() < 1e-6);
  }
}

TEST_CASE("match_grains: specks are in nobody's way, and small grains are followed",
          "[match_grains]") {
  MovedGrainsOptions options;
  options.count = 113;
  const MovedGrains plain = movedGrains(options);
  openvdb::BBoxd box;
  for (const GrainFeatures& grain : plain.before.grains) box.expand(grain.center);
  Dice dice(7);
  const auto somewhere = [&] {
    const double x = dice.uniform(), y = dice.uniform();
    return box.min() + box.extents() * openvdb::Vec3d(x, y, dice.uniform());
  };
  MovedGrains specks = plain, small = plain;
  for (int32_t n = 0; n < 1900; ++n) {
    const GrainFeatures speck{1000 + n, somewhere(), 1. + n % 2, {}};
    GrainFeatures other = speck;
    other.center = plain.motion(somewhere());
    specks.before.grains.push_back(speck);
    specks.after.grains.push_back(other);
    if (n >= 200) continue;
    other.center = plain.motion(speck.center);
    small.before.grains.push_back(speck);
    small.after.grains.push_back(other);
    small.partners[speck.grain] = other.grain;
  }
  const auto alone = matchGrains(plain.before, plain.after),
             beside = matchGrains(specks.before, specks.after),
             both = matchGrains(small.before, small.after);
  REQUIRE((alone && beside && both));
  CHECK(beside->count == alone->count);
  CHECK(scoreOf(specks, *beside).wrong == 0);
  const MatchScore score = scoreOf(small, *both);
  CHECK(share(score.right, score.all) > 0.9);
  CHECK(score.wrong == 0);
}

TEST_CASE("match_grains: few grains are followed by a guess", "[match_grains]") {
  MovedGrainsOptions options;
  options.count = 5;
  options.changed = 0;
  options.degrees = 170;
  const MovedGrains moved = movedGrains(options);
  CHECK(!matchGrains(moved.before, moved.after));
  Motion guess = moved.motion;
  guess.shift += openvdb::Vec3d(1, -1, 1);
  const auto matches = matchGrains(moved.before, moved.after, {MotionKind::affine, guess});
  REQUIRE(matches);
  CHECK(scoreOf(moved, *matches).right == 5);
  options.count = 500;
  const MovedGrains more = movedGrains(options);
  const auto far = matchGrains(more.before, more.after, {MotionKind::affine, more.motion});
  CHECK(scoreOf(more, *far).right == 500);
}

TEST_CASE("match_grains: strangers have no motion", "[match_grains]") {
  MovedGrainsOptions options;
  options.count = 200;
  const MovedGrains moved = movedGrains(options);
  options.seed = 9;
  const MovedGrains other = movedGrains(options);
  for (const MotionKind kind : {MotionKind::rigid, MotionKind::affine, MotionKind::free})
    CHECK(!matchGrains(moved.before, other.after, {kind, {}}));
  CHECK(!matchGrains({}, {}));
  CHECK(!matchGrains(moved.before, {}));
  CHECK(!matchGrains({}, moved.after));
}

TEST_CASE("match_grains: the same for any number of threads", "[match_grains]") {
  MovedGrainsOptions options;
  options.count = 400;
  options.noise = 0.1;
  options.changed = 0.1;
  const MovedGrains moved = movedGrains(options);
  const auto run = [&](int threads) {
    return withThreads(threads, [&] {
      const auto matches = matchGrains(moved.before, moved.after);
      REQUIRE(matches);
      std::vector<double> all;
      for (const FollowedGrain& match : matches->grains)
        all.insert(all.end(), {double(match.partner), match.confidence, match.miss,
                               match.gradient ? match.gradient->det() : 0});
      return all;
    });
  };
  CHECK(run(1) == run(4));
}

TEST_CASE("match_grains: grains that make no sense are refused, and work can be stopped",
          "[match_grains]") {
  const MovedGrains moved = movedGrains({});
  const auto refused = [&](const std::function<void(GrainFeatures&)>& change) {
    GrainSet set = moved.before;
    change(set.grains[3]);
    CHECK_THROWS_AS(matchGrains(set, moved.after), InvalidInput);
  };
  refused([](GrainFeatures& g) { g.grain = 1; });
  refused([](GrainFeatures& g) { g.volume = 0; });
  refused([](GrainFeatures& g) { g.center[1] = std::nan(""); });
  refused([](GrainFeatures& g) { g.moments[4] = std::numeric_limits<double>::infinity(); });
  for (const double scale : {0.0, -1.0, double(std::nanf("")), 1e200}) {  // no guess of a motion
    Motion guess;
    guess.linear *= scale;
    CHECK_THROWS_AS(matchGrains(moved.before, moved.after, {MotionKind::affine, guess}),
                    InvalidInput);
  }
  StopAtOnce stop;
  CHECK_THROWS_AS(matchGrains(moved.before, moved.after, {}, &stop), Interrupted);
}
