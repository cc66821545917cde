// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/measure/measure_binder.h"

#include <cmath>

#include "support/catch.h"
#include "support/known_bodies.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/grids/grid_metadata.h"

using namespace vdb_madf;
using namespace vdb_madf::test;

namespace {

/// Two balls and a cylinder between their centers.
struct BridgedBalls {
  Vec3d center{32.2, 31.7, 32.4}, axis{1, 0, 0};
  double radius = 14, distance = 34, bridge = 7;

  Vec3d at(int ball) const { return center + (ball - 0.5) * distance * axis; }
  int ballOf(const Vec3d& p) const {
    for (const int ball : {0, 1})
      if ((p - at(ball)).length() < radius) return ball + 1;
    return 0;
  }
  bool isBinder(const Vec3d& p) const {
    const double along = (p - center).dot(axis);
    return std::abs(along) < distance / 2 && (p - center - along * axis).length() < bridge;
  }
  // Balls apart: the cylinder between the centers without what of it lies in the balls.
  double volume() const {
    const double flat = std::pow(radius * radius - bridge * bridge, 1.5);
    return M_PI * bridge * bridge * distance - 4 * M_PI / 3 * (std::pow(radius, 3) - flat);
  }
  double cover() const {
    return 2 * M_PI * radius * (radius - std::sqrt(radius * radius - bridge * bridge));
  }
};

constexpr int kSide = 64;
const CoordBBox kBox(Coord(0), Coord(kSide - 1));

template <typename IsBinder>
MaskGrid::Ptr binderWhere(const IsBinder& isBinder) {
  auto binder = MaskGrid::create();
  for (auto p = kBox.begin(); p; ++p)
    if (isBinder((*p).asVec3d())) binder->tree().setValueOn(*p);
  setDomain(*binder, kBox);
  return binder;
}

Measurements measureBridges(const Int32Grid& labels, const MaskGrid& binder) {
  Measurements measured = measure(labels);
  measureBinder(labels, binder, {}, measured);
  return measured;
}

}  // namespace

TEST_CASE("measure_binder: a cylinder between two balls", "[measure_binder]") {
  for (const Vec3d axis : {Vec3d(1, 0, 0), Vec3d(1, 2, 3), Vec3d(-2, 1, 1)}) {
    BridgedBalls body;
    body.axis = axis.unit();
    const auto labels =
        drawLabels(kBox, [&](const Vec3d& p) { return 5 * body.ballOf(p); });  // 5 and 10
    setDomain(*labels, kBox);
    // Binder within grains, as a map of phases may have it, does not count.
    const auto binder = binderWhere([&](const Vec3d& p) { return body.isBinder(p); });
    const Measurements measured = measureBridges(*labels, *binder);
    CAPTURE(axis);
    REQUIRE(measured.binder->bridges.size() == 1);
    const Bridge& bridge = measured.binder->bridges.front();
    CHECK(bridge.first == 5);
    CHECK(bridge.second == 10);
    CHECK_FALSE(bridge.bonded);
    CHECK(bridge.volume == Approx(body.volume()).epsilon(0.02));
    // A voxel at the rim may have no face neighbor.
    CHECK(measured.binder->looseVolume <= 2);
    CHECK(measured.binder->volume == bridge.volume + measured.binder->looseVolume);
    CHECK(bridge.section == Approx(M_PI * 49).epsilon(0.05));
    CHECK(bridge.sectionRadius == Approx(7).epsilon(0.03));
    CHECK(bridge.firstCover == Approx(body.cover()).epsilon(0.06));
    CHECK(bridge.secondCover == Approx(body.cover()).epsilon(0.06));
    CHECK(bridge.firstShare ==
          Approx(body.cover() / (4 * M_PI * body.radius * body.radius)).epsilon(0.06));
  }
}

TEST_CASE("measure_binder: a collar around a bond counts without the bond", "[measure_binder]") {
  BridgedBalls body;
  body.axis = Vec3d(1, 1, 2).unit();
  body.distance = 26;  // the balls meet in a disc of radius sqrt(14^2 - 13^2) = 5.2
  body.bridge = 8;
  const auto labels = drawLabels(kBox, [&](const Vec3d& p) {
    return body.ballOf(p) == 0 ? 0 : (p - body.at(0)).length() < (p - body.at(1)).length() ? 1 : 2;
  });
  setDomain(*labels, kBox);
  const auto binder = binderWhere([&](const Vec3d& p) { return body.isBinder(p); });
  const Measurements measured = measureBridges(*labels, *binder);
  REQUIRE(measured.bonds.size() == 1);
  REQUIRE(measured.binder->bridges.size() == 1);
  const Bridge& bridge = measured.binder->bridges.front();
  CHECK(bridge.bonded);
  CHECK(bridge.section == Approx(M_PI * (64 - 27)).epsilon(0.06));

  MeasureOptions coarse;  // the contact is no bond then, and no binder, either
  coarse.minFaces = measured.bonds[0].faces + 1;
  Measurements fewer = measure(*labels, coarse);
  REQUIRE(fewer.bonds.empty());
  measureBinder(*labels, *binder, coarse, fewer);
  CHECK_FALSE(fewer.binder->bridges.front().bonded);
  CHECK(fewer.binder->bridges.front().section == bridge.section);
}

TEST_CASE("measure_binder: binder goes to the neighbor it reaches first", "[measure_binder]") {
  // Three cubes in a row, with two voxels between, and binder that fills both gaps, coats the
  // first from behind, and lies apart from all.
  auto labels = Int32Grid::create(0);
  for (int i = 0; i < 3; ++i)
    labels->fill(CoordBBox::createCube(Coord(10 + 6 * i, 20, 20), 4), 3 - i);
  setDomain(*labels, kBox);
  auto binder = MaskGrid::create();
  binder->fill(CoordBBox(Coord(14, 20, 20), Coord(15, 23, 23)), true);
  binder->fill(CoordBBox(Coord(20, 20, 20), Coord(21, 22, 23)), true);
  binder->fill(CoordBBox(Coord(8, 20, 20), Coord(9, 21, 21)), true);
  binder->fill(CoordBBox(Coord(40, 40, 40), Coord(42, 40, 40)), true);
  setDomain(*binder, kBox);
  const Measurements measured = measureBridges(*labels, *binder);
  REQUIRE(measured.binder->bridges.size() == 2);
  const Bridge &low = measured.binder->bridges[0], &high = measured.binder->bridges[1];
  CHECK(low.first == 1);
  CHECK(low.second == 2);
  CHECK(low.voxels == 24);
  CHECK(high.first == 2);
  CHECK(high.second == 3);
  CHECK(high.voxels == 32);
  CHECK(measured.binder->volume == 24 + 32 + 8 + 3);
  CHECK(measured.binder->looseVolume == 8 + 3);

  // All gaps and the sides in one piece: the cube in the middle shares it out by steps.
  for (int x = 10; x < 26; ++x) binder->tree().setValueOn(Coord(x, 24, 20));
  const Measurements joined = measureBridges(*labels, *binder);
  REQUIRE(joined.binder->bridges.size() == 2);
  CHECK(joined.binder->bridges[0].voxels + joined.binder->bridges[1].voxels == 24 + 32 + 16);
  CHECK(joined.binder->bridges[1].voxels == 32 + 4 + 2 + 2);  // as far as the middle of the cube
}

TEST_CASE("measure_binder: no binder, one grain, and maps of other voxels", "[measure_binder]") {
  const auto labels = drawLabels({Coord(3), Coord(6)}, [](const Vec3d&) { return 1; });
  setDomain(*labels, kBox);
  const auto none = binderWhere([](const Vec3d&) { return false; });
  CHECK(measureBridges(*labels, *none).binder->volume == 0);
  const auto some = binderWhere([](const Vec3d& p) { return p[0] == 7 && p[1] == 4; });
  const Measurements one = measureBridges(*labels, *some);
  CHECK(one.binder->bridges.empty());
  CHECK(one.binder->looseVolume == kSide);
  CHECK(vdb_madf::noteOn(*one.binder, 1).empty());
  const auto noGrains = Int32Grid::create(0);
  setDomain(*noGrains, kBox);
  CHECK(measureBridges(*noGrains, *some).binder->volume == kSide);
  CHECK(measureBridges(*noGrains, *some).binder->looseVolume == kSide);
  setDomain(*some, CoordBBox(Coord(1), Coord(kSide - 1)));
  CHECK_THROWS_WITH(measureBridges(*labels, *some),
                    vdb_madf::test::Contains("the phases have 63x63x63 voxels from 1,1,1 on, the "
                                             "labels 64x64x64 voxels"));
  setDomain(*some, kBox);
  setDomain(*labels, CoordBBox(Coord(1), Coord(kSide - 1)));  // a part of the scan
  CHECK(measureBridges(*labels, *some).binder->looseVolume == kSide - 1);
  CHECK_THROWS_WITH(measureBridges(*labels, *MaskGrid::create()),
                    vdb_madf::test::Contains("is unknown"));
}
