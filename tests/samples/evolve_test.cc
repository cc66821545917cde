// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/samples/evolve.h"

#include <cmath>
#include <map>
#include <set>
#include <utility>

#include "support/catch.h"
#include "support/label_shapes.h"
#include "support/runs.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/grids/grid_metadata.h"
#include "vdb_madf/samples/detail/random.h"
#include "vdb_madf/samples/particles.h"

namespace {

using namespace vdb_madf;
using namespace vdb_madf::test;
using openvdb::Vec3d;

Int32Grid::Ptr fewGrains() {
  ParticleOptions options;
  options.size = {56, 50, 60};
  options.count = 24;
  options.minRadius = 5;
  options.maxRadius = 8;
  return generateParticles(options).truth;
}

EvolveOptions someMotion() {
  EvolveOptions options;
  options.steps = 2;
  options.strain = 0.16;
  options.shear = 0.05;
  options.degrees = 13;
  options.axis = {1, 2, 2};
  options.drift = {2.3, -1.7, 0.9};
  return options;
}

EvolvedStep evolved(const Int32Grid& labels, const EvolveOptions& options, int step) {
  return Evolution(labels, options).after(step);
}

/// The voxel that a place lies in.
Coord voxelAt(const Vec3d& place) {
  return Coord::floor(place + Vec3d(0.5));
}

Vec3d centerOf(const Int32Grid& labels, int32_t label, int64_t voxels) {
  Vec3d sum(0);
  for (auto voxel = labels.cbeginValueOn(); voxel; ++voxel)
    if (*voxel == label) sum += voxel.getCoord().asVec3d();
  return sum / double(voxels);
}

uint64_t evolvedHash(const Int32Grid& labels) {
  uint64_t state = 0;
  for (auto p = vdb_madf::boxOf(labels).begin(); p; ++p)
    state = detail::mixBits(state ^ uint64_t(labels.tree().getValue(*p)));
  return state;
}

}  // namespace

// Whoever compares methods on these samples relies on a seed giving the same sample for ever.
TEST_CASE("evolve: the bits are fixed, for any threads", "[evolve]") {
  const auto labels = fewGrains();
  EvolveOptions options = someMotion();
  options.vanish = 0.2;
  options.noise = 0.5;
  options.rigidGrains = true;
  for (const int threads : {1, 2})
    CHECK(withThreads(threads, [&] { return evolvedHash(*evolved(*labels, options, 2).labels); }) ==
          0x9df232bb86c2c16eu);
  options.seed = 2;
  CHECK(evolvedHash(*evolved(*labels, options, 2).labels) != 0x9df232bb86c2c16eu);
}

TEST_CASE("evolve: the motion is what was asked for", "[evolve]") {
  const auto labels = fewGrains();
  EvolveOptions options;
  options.steps = 2;
  options.degrees = 180;
  const auto turned = evolved(*labels, options, 1);  // by 90 degrees about z
  CHECK((turned.motion.linear * Vec3d(1, 0, 0) - Vec3d(0, 1, 0)).length() < 1e-14);
  CHECK((turned.motion.linear * Vec3d(0, 1, 0) - Vec3d(-1, 0, 0)).length() < 1e-14);
  CHECK((turned.motion.linear * Vec3d(0, 0, 1) - Vec3d(0, 0, 1)).length() < 1e-14);

  // The voxels stay where they are in the world.
  const auto placed = labels->deepCopy();
  placed->transform().preTranslate(Vec3d(3, 0, -7));
  CHECK(evolved(*placed, options, 1).labels->indexToWorld(Vec3d(0)) ==
        placed->indexToWorld(Vec3d(0)));

  options = someMotion();
  const auto partly = evolved(*labels, options, 1);
  const Vec3d center = vdb_madf::boxOf(*labels).getCenter(), axis(1, 2, 2);
  CHECK((partly.motion(center) - center - options.drift / 2).length() < 1e-12);
  // R keeps its axis, and S takes off 8 % of z.
  CHECK(partly.motion.linear.det() == Approx(0.92));
  options.degrees = 0;
  CHECK(evolved(*labels, options, 2)
            .motion.linear.eq(openvdb::Mat3d(1., 0., 0.05, 0., 1., 0., 0., 0., 0.84), 1e-12));
  options = someMotion();
  options.strain = options.shear = 0;
  const openvdb::Mat3d turn = evolved(*labels, options, 2).motion.linear;
  CHECK((turn * axis - axis).length() < 1e-12);
  CHECK((turn(0, 0) + turn(1, 1) + turn(2, 2)) ==
        Approx(1 + 2 * std::cos(13 * 3.141592653589793 / 180)));
  CHECK((turn * turn.transpose()).eq(openvdb::Mat3d::identity(), 1e-12));
}

TEST_CASE("evolve: a voxel has the label of where it comes from", "[evolve]") {
  const auto labels = fewGrains();
  const CoordBBox box = vdb_madf::boxOf(*labels);
  const Evolution evolution(*labels, someMotion());
  for (const int step : {0, 1, 2}) {
    const EvolvedStep result = evolution.after(step);
    const openvdb::Mat3d back = result.motion.linear.inverse();
    std::map<int32_t, int64_t> sizes;
    std::set<int32_t> leaving;
    int64_t wrong = 0;
    for (auto p = CoordBBox(box.min() - Coord(20), box.max() + Coord(20)).begin(); p; ++p) {
      const int32_t label =
          labels->tree().getValue(voxelAt(back * ((*p).asVec3d() - result.motion.shift)));
      const bool isInside = box.isInside(*p);
      wrong += result.labels->tree().getValue(*p) != (isInside ? label : 0);
      if (label && isInside) ++sizes[label];
      if (label && !isInside) leaving.insert(label);
    }
    CHECK(wrong == 0);
    CHECK(storedDomain(*result.labels)->box() == box);
    CHECK(leaving.empty() == (step == 0));
    for (const EvolvedGrain& grain : result.grains) {
      CAPTURE(step, grain.grain);
      CHECK(grain.voxels == sizes[grain.grain]);
      CHECK(grain.fate == (leaving.count(grain.grain) ? EvolvedFate::left : EvolvedFate::kept));
    }
  }
}

TEST_CASE("evolve: at half voxels all grains go the same way", "[evolve]") {
  const auto labels = fewGrains();
  EvolveOptions options;
  options.steps = 1;
  options.drift = {0.5, -0.5, 0.5};
  const auto moved = evolved(*labels, options, 1).labels;
  int64_t wrong = 0;
  for (auto p = vdb_madf::boxOf(*labels).begin(); p; ++p)
    wrong += moved->tree().getValue(*p) != labels->tree().getValue(*p - Coord(0, -1, 0));
  CHECK(wrong == 0);
}

TEST_CASE("evolve: rigid grains keep their shapes where nothing is in their way", "[evolve]") {
  LabelMap voxels;
  for (auto p = CoordBBox(Coord(10), Coord(22, 16, 13)).begin(); p; ++p) voxels[*p] = 3;
  for (auto p = CoordBBox(Coord(30, 8, 30), Coord(36, 20, 34)).begin(); p; ++p) voxels[*p] = 9;
  const auto labels = labelGrid(voxels);
  EvolveOptions options = someMotion();
  options.rigidGrains = true;
  const EvolvedStep result = evolved(*labels, options, 2);
  for (const EvolvedGrain& grain : result.grains) {
    CAPTURE(grain.grain);
    const auto before = double(volumes(voxels)[grain.grain]);
    CHECK(std::abs(double(grain.voxels) - before) < 0.05 * before);
    CHECK((centerOf(*result.labels, grain.grain, grain.voxels) - grain.center).length() < 0.2);
    const Vec3d whole = result.motion(centerOf(*labels, grain.grain, int64_t(before)));
    CHECK((grain.center - whole).length() < 1e-9);
  }
  // Pushed into each other, they share the voxels by the distance of their centers.
  voxels.clear();
  for (auto p = cube(10).begin(); p; ++p) voxels[*p] = 1;
  for (auto p = cube(10, {0, 0, 10}).begin(); p; ++p) voxels[*p] = 2;
  options = {};
  options.rigidGrains = true;
  options.strain = 0.5;
  const auto pushed = evolved(*labelGrid(voxels), options, options.steps).labels;
  for (int z = 0; z < 20; ++z) {
    CAPTURE(z);
    CHECK(pushed->tree().getValue({5, 5, z}) == (z < 2 || z > 16 ? 0 : z < 10 ? 1 : 2));
  }
}

TEST_CASE("evolve: what has vanished stays so, and noise is at boundaries alone", "[evolve]") {
  const auto labels = fewGrains();
  EvolveOptions options;
  options.steps = 3;
  options.vanish = 0.6;
  std::set<int32_t> gone;
  for (int step = 0; step <= 3; ++step) {
    const EvolvedStep result = evolved(*labels, options, step);
    for (const EvolvedGrain& grain : result.grains) {
      CHECK((grain.voxels == 0) == (grain.fate == EvolvedFate::vanished));
      if (grain.fate == EvolvedFate::vanished)
        gone.insert(grain.grain);
      else
        CHECK_FALSE(gone.count(grain.grain));
    }
    CHECK(gone.empty() == (step == 0));
  }
  CHECK(gone.size() > 8);
  CHECK(gone.size() < 20);

  options.vanish = 0;
  options.noise = 0.4;  // 2.4 voxels at most
  CHECK(evolvedHash(*evolved(*labels, options, 0).labels) == evolvedHash(*labels));
  const auto rough = evolved(*labels, options, 3).labels;
  int64_t changed = 0, inside = 0;
  for (auto p = vdb_madf::boxOf(*labels).begin(); p; ++p) {
    const int32_t label = labels->tree().getValue(*p);
    if (rough->tree().getValue(*p) == label) continue;
    ++changed;
    bool isInside = true;
    for (auto q = CoordBBox(*p - Coord(3), *p + Coord(3)).begin(); q; ++q)
      isInside = isInside && labels->tree().getValue(*q) == label;
    inside += isInside;
  }
  CHECK(changed > 1000);
  CHECK(inside == 0);
}

TEST_CASE("evolve: bonds that break leave a gap, and nothing else changes", "[evolve]") {
  const auto labels = fewGrains();
  EvolveOptions options;
  options.steps = 2;
  options.breaks = 0.9;
  options.gap = 3;
  const Evolution evolution(*labels, options);
  std::set<std::pair<int32_t, int32_t>> gone;
  for (int step = 0; step <= 2; ++step) {
    CAPTURE(step);
    const EvolvedStep result = evolution.after(step);
    std::set<std::pair<int32_t, int32_t>> broken;
    for (const EvolvedBond& bond : result.bonds) {
      const bool isBroken = bond.fate == EvolvedBondFate::broken;
      CHECK(
          (isBroken || bond.fate == EvolvedBondFate::kept || bond.fate == EvolvedBondFate::parted));
      CHECK((bond.fate == EvolvedBondFate::kept) == (bond.faces > 0));
      if (isBroken) broken.insert({bond.first, bond.second});
    }
    for (const auto& bond : gone) CHECK(broken.count(bond));
    gone = broken;
    CHECK(broken.empty() == (step == 0));
    int64_t wrong = 0;
    for (auto p = vdb_madf::boxOf(*labels).begin(); p; ++p) {
      const int32_t label = labels->tree().getValue(*p);
      bool isNear = false;
      for (auto q = CoordBBox(*p - Coord(3), *p + Coord(3)).begin(); label && q; ++q) {
        const int32_t other = labels->tree().getValue(*q);
        isNear = isNear || ((*q - *p).asVec3d().lengthSqr() <= 9 && other && other != label &&
                            broken.count(std::minmax(label, other)));
      }
      wrong += result.labels->tree().getValue(*p) != (isNear ? 0 : label);
    }
    CHECK(wrong == 0);
  }
  CHECK(gone.size() > 4);
}

TEST_CASE("evolve: grains grow, dissolve and enter as they are told to", "[evolve]") {
  const auto labels = fewGrains();
  const CoordBBox box = vdb_madf::boxOf(*labels);
  for (const double growth : {2.5, -1.5}) {
    CAPTURE(growth);
    EvolveOptions options;
    options.steps = 1;
    options.growth = growth;
    const auto grown = evolved(*labels, options, 1).labels;
    int64_t wrong = 0, changed = 0;
    for (auto p = box.begin(); p; ++p) {
      const int32_t own = labels->tree().getValue(*p), now = grown->tree().getValue(*p);
      double nearest = 100;  // what is empty, or else a label
      std::set<int32_t> there;
      for (auto q = CoordBBox(*p - Coord(2), *p + Coord(2)).begin(); q; ++q) {
        const int32_t other = labels->tree().getValue(*q);
        const double away = (*q - *p).asVec3d().length();
        if (!box.isInside(*q) || (other > 0) == (own > 0) || away > nearest) continue;
        if (away < nearest) there.clear();
        nearest = away;
        there.insert(other);
      }
      const bool isReached = nearest <= std::abs(growth) && (own > 0) == (growth < 0);
      wrong += isReached ? !there.count(now) : now != own;
      changed += now != own;
    }
    CHECK(wrong == 0);
    CHECK(changed > 1000);
  }
  EvolveOptions options;
  options.steps = 3;
  options.enter = 0.6;
  const Evolution evolution(*labels, options);
  size_t before = 100;
  for (int step = 0; step <= 3; ++step) {
    CAPTURE(step);
    size_t absent = 0;
    for (const EvolvedGrain& grain : evolution.after(step).grains) {
      CHECK((grain.voxels == 0) == (grain.fate == EvolvedFate::absent));
      absent += grain.fate == EvolvedFate::absent;
    }
    CHECK(absent <= before);
    if (step == 0) CHECK((absent > 8 && absent < 20));
    if (step == 3) CHECK(absent == 0);
    before = absent;
  }
}

TEST_CASE("evolve: the region and the boundary are those of before", "[evolve]") {
  const auto labels = fewGrains();
  MaskTree round;
  for (auto p = vdb_madf::boxOf(*labels).begin(); p; ++p)
    if (std::pow((*p).x() - 28, 2) + std::pow((*p).y() - 25, 2) < 400) round.setValueOn(*p);
  labels->tree().topologyIntersection(round);
  for (auto value = labels->beginValueOff(); value; ++value) value.setValue(0);
  setDomain(*labels, Domain(round));
  setBoundary(*labels, Boundary::closed);
  EvolveOptions options;
  options.steps = 1;
  options.drift = {5, 0, 0};
  const Evolution evolution(*labels, options);
  const EvolvedStep before = evolution.after(0), after = evolution.after(1);
  for (const EvolvedStep* step : {&before, &after}) {
    CHECK(*storedDomain(*step->labels) == Domain(round));
    CHECK(storedBoundary(*step->labels) == Boundary::closed);
  }
  CHECK(evolvedHash(*before.labels) == evolvedHash(*labels));
  int left = 0;
  for (auto p = vdb_madf::boxOf(*labels).begin(); p; ++p) {
    const int32_t moved = labels->tree().getValue(*p - Coord(5, 0, 0));
    REQUIRE(after.labels->tree().getValue(*p) == (round.isValueOn(*p) ? moved : 0));
    left += moved > 0 && !round.isValueOn(*p);
  }
  CHECK(left > 100);
  for (const EvolvedGrain& grain : after.grains)
    CHECK((grain.fate == EvolvedFate::left || grain.fate == EvolvedFate::kept));
}

TEST_CASE("evolve: bad options are refused, and it stops when asked to", "[evolve]") {
  const auto labels = fewGrains();
  const auto refuses = [&](auto change) {
    EvolveOptions options;
    change(options);
    CHECK_THROWS_AS(evolved(*labels, options, 1), InvalidInput);
  };
  refuses([](auto& o) { o.steps = 0; });
  refuses([](auto& o) { o.strain = 1; });
  refuses([](auto& o) { o.shear = std::nan(""); });
  refuses([](auto& o) { o.degrees = 181; });
  refuses([](auto& o) { o.axis = {0, 0, 0}; });
  refuses([](auto& o) { o.drift = {0, 1e9, 0}; });
  refuses([](auto& o) { o.vanish = 1.1; });
  refuses([](auto& o) { o.noise = -1; });
  refuses([](auto& o) { o.enter = -0.1; });
  refuses([](auto& o) { o.breaks = 1.1; });
  refuses([](auto& o) { o.gap = 9; });
  refuses([](auto& o) { o.growth = -9; });
  CHECK_THROWS_AS(evolved(*labels, EvolveOptions{}, 5), InvalidInput);
  for (const int polls : {0, 1, 3}) {
    StopAfter stop(polls);
    CHECK_THROWS_AS(Evolution(*labels, EvolveOptions{}, &stop).after(1, &stop), Interrupted);
  }
}
