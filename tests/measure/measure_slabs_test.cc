// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

// Labels in slabs are measured as they are in one piece, wherever they are cut.

#include <tbb/global_control.h>

#include <random>
#include <sstream>

#include "support/catch.h"
#include "support/label_shapes.h"
#include "support/label_slabs.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/grids/grid_metadata.h"
#include "vdb_madf/measure/columns.h"
#include "vdb_madf/measure/measure.h"

using namespace vdb_madf;
using namespace vdb_madf::test;

namespace {

/// All numbers, to the last bit.
std::string textOf(const Measurements& m) {
  std::ostringstream text;
  text << std::hexfloat << m.labelDigest << " " << m.gridName << " " << m.open << " " << m.edges;
  for (const auto& columns : {grainColumns(m.grains, m.extra), bondColumns(m.bonds, m.extra)})
    for (const MeasureColumn& column : columns) {
      text << "\n" << column.name;
      for (const double value : column.values) text << " " << value;
    }
  const SampleMeasures& s = m.sample;
  text << "\n"
       << s.box << s.domainKnown << " " << s.objectVoxels << " " << s.objectFraction << " "
       << s.freeArea << " " << s.sharedArea << " " << s.eulerCharacteristic << " " << s.components
       << " " << s.meanCoordination << " " << s.contactsLeftOut << " " << s.areaLeftOut << " "
       << s.bondsWithoutCurvature << " " << s.bondToGrainRatio.value_or(-1);
  for (const auto& length : s.correlationLengths) text << " " << length.value_or(-1);
  for (const double value : s.grainFabric.components) text << " " << value;
  for (const double value : s.bondFabric.components) text << " " << value;
  for (const MeanInterval& mean : m.intervals)
    text << "\n" << mean.name << " " << mean.low.value_or(-1) << " " << mean.high.value_or(-1);
  return text.str();
}

void requireSameInSlabs(const Int32Grid::Ptr& labels, const std::vector<int>& cuts,
                        const MeasureOptions& options = {}) {
  REQUIRE(textOf(measure(inSlabs(labels, cuts), options)) == textOf(measure(*labels, options)));
}

/// Cells around random places, some of them background.
Int32Grid::Ptr randomGrains(std::mt19937& random, const CoordBBox& box, int places,
                            int background) {
  const auto within = [&](int axis) {
    return box.min()[axis] + int(random() % unsigned(box.dim()[axis]));
  };
  std::vector<std::pair<Coord, int32_t>> centers;
  for (int i = 0; i < places; ++i)
    centers.push_back({Coord(within(0), within(1), within(2)),
                       int(random() % 100) < background ? 0 : int32_t(random() % 90 + 1)});
  const auto grid = Int32Grid::create(0);
  grid->setName("grain");
  for (auto p = box.begin(); p; ++p) {
    int64_t nearest = std::numeric_limits<int64_t>::max();
    int32_t label = 0;
    for (const auto& [center, of] : centers) {
      const Coord d = *p - center;
      const int64_t squared = int64_t(d.x()) * d.x() + d.y() * d.y() + d.z() * d.z();
      if (squared >= nearest) continue;
      nearest = squared;
      label = of;
    }
    if (label > 0 && random() % 50 > 0) grid->tree().setValueOn(*p, label);
  }
  return grid;
}

std::vector<int> randomCuts(std::mt19937& random, const CoordBBox& box) {
  std::vector<int> cuts{box.min().z() & ~7};
  const int end = (box.max().z() | 7) + 1;
  while (cuts.back() < end)
    cuts.push_back(std::min(end, cuts.back() + 8 * (1 + int(random() % 4))));
  return cuts;
}

}  // namespace

TEST_CASE("measure_slabs: random labels are measured as in one piece", "[measure_slabs]") {
  std::mt19937 random(11);
  for (int i = 0; i < 14; ++i) {
    const Coord first(-9, 4, -21),
        size(10 + int(random() % 20), 8 + int(random() % 20), 20 + int(random() % 70));
    const CoordBBox all(first, first + size);
    const Int32Grid::Ptr labels = randomGrains(random, all, 4 + int(random() % 40), 30);
    if (i % 3 > 0) setDomain(*labels, all);
    if (i % 4 == 1)
      labels->setTransform(openvdb::math::Transform::createLinearTransform(
          openvdb::Mat4d(2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 5, 0, 0, 0, 0, 1)));
    MeasureOptions options;
    options.shape = i % 2 == 0;
    options.boundary = i % 6 == 5 ? Boundary::closed : Boundary::automatic;
    options.edgeWeights = i % 3 > 0 && options.boundary != Boundary::closed;
    options.cells = i % 2 == 1;
    options.bondRadii = i % 4 > 1;
    options.minFaces = i % 5;
    options.bootstrap = i % 8 == 0 ? 100 : 0;
    CAPTURE(i);
    requireSameInSlabs(labels, randomCuts(random, all), options);
    requireSameInSlabs(labels, {-32, 120}, options);
  }
}

TEST_CASE("measure_slabs: single voxels that meet at corners", "[measure_slabs]") {
  for (unsigned seed = 0; seed < 6; ++seed) {
    const auto labels = labelGrid(randomLabels(seed, Coord(-3, 5, -12), 26, 5, 50));
    requireSameInSlabs(labels, {-16, -8, 0, 8, 16});
    requireSameInSlabs(labels, {-24, -16, 8, 24, 40});
  }
  requireSameInSlabs(labelGrid(awkwardLabels()), {-8, 0, 8, 16, 24});
}

TEST_CASE("measure_slabs: what is deeper than the layers around a slab", "[measure_slabs]") {
  // Half balls of radius 60, so that slabs in the middle need 60 layers on both sides.
  const auto labels = Int32Grid::create(0);
  const CoordBBox box(Coord(0, -60, -60), Coord(60, 60, 60));
  for (auto p = box.begin(); p; ++p)
    if ((*p).asVec3d().lengthSqr() < 3600) labels->tree().setValueOn(*p, (*p).x() < 9 ? 2 : 1);
  const std::vector<int> cuts{-64, -56, -40, -8, 0, 8, 24, 64};
  requireSameInSlabs(labels, cuts);
  setDomain(*labels, box);
  requireSameInSlabs(labels, cuts);  // nothing is known beyond x = 0
}

TEST_CASE("measure_slabs: the nearest background lies beyond what is around a slab",
          "[measure_slabs]") {
  // Walls all around but below and above. From z = 40 the background above is seen 40 voxels beyond
  // the slab, at 118, and the nearer one below, at -1, is not.
  const auto labels = Int32Grid::create(0);
  labels->denseFill(CoordBBox(Coord(0), Coord(9, 9, 117)), 4);
  setDomain(*labels, CoordBBox(Coord(0, 0, -8), Coord(9, 9, 127)));
  REQUIRE(measure(*labels).grains[0].inscribedRadius == 59);
  requireSameInSlabs(labels, {-8, 40, 80, 128});
  requireSameInSlabs(labels, {-8, 0, 8, 32, 56, 64, 128});
}

TEST_CASE("measure_slabs: correlations over long distances", "[measure_slabs]") {
  // Layers of 300 voxels along z, in slabs of 8 and 16, and along x.
  for (const int axis : {0, 2}) {
    const auto labels = Int32Grid::create(0);
    CoordBBox box(Coord(0), Coord(5));
    box.max()[axis] = 1199;
    for (auto p = box.begin(); p; ++p)
      if ((*p)[axis] / 300 % 2 == 0) labels->tree().setValueOn(*p, 1 + (*p)[axis] / 99);
    setDomain(*labels, box);
    std::vector<int> cuts{0};
    while (cuts.back() <= box.max().z()) cuts.push_back(cuts.back() + 8 * (1 + cuts.size() % 2));
    REQUIRE(measure(*labels).sample.correlationLengths[size_t(axis)].value() > 40);
    requireSameInSlabs(labels, cuts);
  }
}

TEST_CASE("measure_slabs: labels that fill the domain, and none", "[measure_slabs]") {
  const auto labels = Int32Grid::create(0);
  const CoordBBox box(Coord(0), Coord(15, 9, 39));
  requireSameInSlabs(labels, {0, 8, 16});
  setDomain(*labels, box);
  requireSameInSlabs(labels, {0, 8, 16});
  labels->denseFill(box, 3);
  requireSameInSlabs(labels, {0, 8, 16, 40});
  labels->denseFill(CoordBBox(Coord(0), Coord(15, 9, 20)), 7);
  requireSameInSlabs(labels, {0, 24, 32, 40});
  requireSameInSlabs(labels, {-80, 0, 8, 16, 40, 120});
}

TEST_CASE("measure_slabs: the same with any number of threads", "[measure_slabs]") {
  std::mt19937 random(5);
  const CoordBBox box(Coord(0), Coord(30, 30, 60));
  const Int32Grid::Ptr labels = randomGrains(random, box, 40, 30);
  MeasureOptions options;
  options.shape = true;
  const auto text = [&](size_t threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    return textOf(measure(inSlabs(labels, {0, 16, 24, 64}), options));
  };
  CHECK(text(1) == text(4));
}

TEST_CASE("measure_slabs: what cannot be measured is refused", "[measure_slabs]") {
  const auto labels = labelGrid(awkwardLabels());
  LabelSlabs wrong = inSlabs(labels, {-8, 0, 8, 16, 24});
  wrong.cuts = {-8, 0, 40, 48, 56};
  CHECK_THROWS_WITH(measure(wrong), vdb_madf::test::Contains("beyond its cuts"));
  MeasureOptions options;
  options.domain = CoordBBox(Coord(-20), Coord(20));
  CHECK_THROWS_WITH(measure(inSlabs(labels, {-8, 24}), options),
                    vdb_madf::test::Contains("leaves the domain"));
  MaskTree notched;
  notched.fill(CoordBBox(Coord(-20), Coord(40)), true);
  notched.setValueOff(Coord(-20));
  options.domain = Domain(notched);
  CHECK_THROWS_WITH(measure(inSlabs(labels, {-8, 24}), options),
                    vdb_madf::test::Contains("region"));
}
