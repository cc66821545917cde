// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/measure/size_curve.h"

#include <cmath>
#include <string>

#include "support/catch.h"
#include "support/known_bodies.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/grids/grid_metadata.h"
#include "vdb_madf/measure/measure.h"

using namespace vdb_madf;
using namespace vdb_madf::test;

namespace {

/// Cubes of edges 1, 2 and 3, of 1, 8 and 27 of 36 voxels, the last at the face of the domain.
Int32Grid::Ptr threeCubes() {
  auto labels = Int32Grid::create(0);
  for (int edge = 1; edge <= 3; ++edge)
    labels->fill(CoordBBox::createCube(Coord(6 * edge, 3, 5), edge), edge);
  setDomain(*labels, CoordBBox(Coord(0, 0, 0), Coord(20, 12, 12)));
  return labels;
}

const MeasureColumn& curveColumn(const std::vector<MeasureColumn>& columns,
                                 const std::string& name) {
  for (const MeasureColumn& candidate : columns)
    if (candidate.name == name) return candidate;
  throw std::runtime_error("no column " + name);
}

double deviationOf(const Measurements& measured, const std::string& size) {
  for (const SizeDeviation& deviation : measured.sizeDeviations)
    if (deviation.size == size) return deviation.percent;
  throw std::runtime_error("no deviation of " + size);
}

}  // namespace

TEST_CASE("size_curve: cubes count by their volume", "[size_curve]") {
  MeasureOptions options;
  options.sizes = true;
  const auto curve = sizeCurve(measure(*threeCubes(), options));
  REQUIRE(curve.size() == 5);
  for (int percent = 0; percent <= 100; ++percent) {
    const size_t row = size_t(percent);
    const double edge = 36 * percent <= 100 ? 1 : 36 * percent <= 900 ? 2 : 3;
    CAPTURE(percent);
    CHECK(curveColumn(curve, "percent_passing").values.at(row) == percent);
    CHECK(curveColumn(curve, "feret_min").values.at(row) == Approx(edge));
    CHECK(curveColumn(curve, "equivalent_diameter").values.at(row) ==
          Approx(edge * std::cbrt(6 / M_PI)));
    CHECK(curveColumn(curve, "axis2_length").values.at(row) == Approx(edge * std::sqrt(5.0 / 3)));
    CHECK(curveColumn(curve, "projected_diameter").values.at(row) ==
          Approx(edge * std::sqrt(6 / M_PI)));
  }
  options.edgeWeights = true;  // the cube of edge 3 is cut: 1 : 8 by volume
  const Measurements weighted = measure(*threeCubes(), options);
  REQUIRE(weighted.grains[2].edgeWeight == 0);
  CHECK(curveColumn(sizeCurve(weighted), "feret_min").values.back() == Approx(2));
  options.edgeWeights = false;
  const auto none = sizeCurve(measure(*Int32Grid::create(0), options));
  CHECK(std::isnan(curveColumn(none, "equivalent_diameter").values[50]));
}

TEST_CASE("size_curve: sizes of ellipsoids", "[size_curve]") {
  const double a = 20, c = 11;  // half axes a, a, c
  const auto inside = [&](const Vec3d& p) {
    const Vec3d d = p - Vec3d(24.3, 23.6, 24.1);
    return (d[0] * d[0] + d[1] * d[1]) / (a * a) + d[2] * d[2] / (c * c) < 1 ? 1 : 0;
  };
  MeasureOptions options;
  options.sizes = true;
  const auto curve = sizeCurve(measure(*drawLabels({Coord(0), Coord(48)}, inside), options));
  const double e = std::sqrt(1 - c * c / (a * a));
  const double surface = 2 * M_PI * a * a * (1 + (1 - e * e) / e * std::atanh(e));
  CHECK(curveColumn(curve, "equivalent_diameter").values[50] ==
        Approx(2 * std::cbrt(a * a * c)).epsilon(0.005));
  CHECK(curveColumn(curve, "axis2_length").values[50] == Approx(2 * a).epsilon(0.005));
  // The corners of voxels stand out.
  CHECK(curveColumn(curve, "feret_min").values[50] - 2 * c == Approx(0.7).margin(0.9));
  CHECK(curveColumn(curve, "projected_diameter").values[50] - std::sqrt(surface / M_PI) ==
        Approx(0.8).margin(0.8));
}

TEST_CASE("size_curve: deviations from another curve", "[size_curve]") {
  MeasureOptions options;
  // 1 of 36 pass at 1.5, 9 of 36 at 2, and beyond 95 % nothing counts.
  options.sizeReference = parseSizeReference(
      "size_voxel,percent_passing\n1,0\n1.5,6\r\n\n2.0000001 , 30\n2.5,40\n3,96\n4,100");
  REQUIRE(options.sizeReference->points.size() == 6);
  const Measurements measured = measure(*threeCubes(), options);
  CHECK(measured.sizeDeviations.size() == 4);
  const double at1 = 100 / 36.0 - 6, at2 = 25 - 30, at25 = 25 - 40;
  CHECK(deviationOf(measured, "feret_min") ==
        Approx(std::sqrt((at1 * at1 + at2 * at2 + at25 * at25) / 3)));
  CHECK(measured.grains.front().shape);

  // The same in micrometers, of voxels of 20 um.
  const auto labels = threeCubes();
  setVoxelSize(*labels, VoxelSize(20e-6));
  CHECK_THROWS_WITH(measure(*labels, options), vdb_madf::test::Contains("are in voxels"));
  options.sizeReference =
      parseSizeReference("size_um,percent_passing\n30,6\n40.000001,30\n50,40\n60,96\n");
  CHECK(deviationOf(measure(*labels, options), "feret_min") ==
        Approx(deviationOf(measured, "feret_min")));
  CHECK_THROWS_WITH(measure(*threeCubes(), options),
                    vdb_madf::test::Contains("are in um, and the voxel size is unknown"));
}

TEST_CASE("size_curve: sizes and shares that tables show as equal are equal", "[size_curve]") {
  MeasureOptions options;  // 3 * 0.1 > 0.3 in doubles
  options.sizeReference = parseSizeReference("size_mm,percent_passing\n0.3,95\n");
  const auto cubes = threeCubes();
  setVoxelSize(*cubes, VoxelSize(1e-4));
  CHECK(deviationOf(measure(*cubes, options), "feret_min") == Approx(5));
  auto rods = Int32Grid::create(0);  // 0.07 * 100 > 7
  rods->fill(CoordBBox(Coord(0), Coord(6, 0, 0)), 1);
  rods->fill(CoordBBox(Coord(0, 5, 0), Coord(92, 5, 0)), 2);
  setDomain(*rods, CoordBBox(Coord(-1), Coord(99, 9, 9)));
  const Measurements measured = measure(*rods, options = {});
  CHECK(curveColumn(sizeCurve(measured), "equivalent_diameter").values[7] ==
        Approx(measured.grains[0].equivalentDiameter));
}

TEST_CASE("size_curve: what is no curve is refused", "[size_curve]") {
  const std::string begin = "size_mm,percent_passing\n";
  for (const auto& [text, what] : std::vector<std::pair<std::string, std::string>>{
           {"", "begins with the line size_mm,percent_passing"},
           {"0.1,50\n", "this one with '0.1,50'"},
           {"size_parsec,percent_passing\n1,50\n", "begins with the line"},
           {"size_mm,percent_retained\n1,50\n", "begins with the line"},
           {begin, "needs a percentage from 5 to 95"},
           {begin + "1,4\n2,96\n", "needs a percentage from 5 to 95"},
           {begin + "1;50\n", "'1;50': is no size"},
           {begin + "0,50\n", "'0,50': is no size"},
           {begin + "1,101\n", "'1,101': is no size"},
           {begin + "1,nan\n", "'1,nan': is no size"},
           {begin + "1,2,3\n", "'1,2,3': is no size"},
           {begin + "1,50\n1,60\n", "have to ascend"},
           {begin + "1,50\n2,40\n", "must not fall"}}) {
    CAPTURE(text);
    CHECK_THROWS_AS(parseSizeReference(text), InvalidInput);
    CHECK_THROWS_WITH(parseSizeReference(text), vdb_madf::test::Contains(what));
  }
}
