// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/measure/columns.h"

#include <cmath>
#include <map>
#include <set>
#include <string>
#include <string_view>

#include "support/catch.h"

using namespace vdb_madf;

namespace {

std::string names(const std::vector<MeasureColumn>& columns) {
  std::string text;
  for (const MeasureColumn& column : columns)
    text += (text.empty() ? "" : " ") + column.name + unitSuffix(column.power, "u");
  return text;
}

const MeasureColumn& column(const std::vector<MeasureColumn>& columns, std::string_view name) {
  for (const MeasureColumn& candidate : columns)
    if (candidate.name == name) return candidate;
  throw std::runtime_error("no column " + std::string(name));
}

}  // namespace

TEST_CASE("columns: names, units and order of the table of grains", "[columns]") {
  CHECK(names(grainColumns({})) ==
        "id voxels volume_u3 equivalent_diameter_u centroid_x_u centroid_y_u centroid_z_u "
        "representative_x_u representative_y_u representative_z_u inscribed_radius_u area_u2 "
        "free_area_u2 shared_area_u2 cut_area_u2 sphericity axis1_length_u axis2_length_u "
        "axis3_length_u aspect_2_to_1 aspect_3_to_2 axis1_x axis1_y axis1_z axis2_x axis2_y "
        "axis2_z axis3_x axis3_y axis3_z box_min_x box_min_y box_min_z box_max_x box_max_y "
        "box_max_z coordination at_domain_face");
}

TEST_CASE("columns: names, units and order of the table of bonds", "[columns]") {
  CHECK(names(bondColumns({})) ==
        "first second faces area_u2 radius_u centroid_x_u centroid_y_u centroid_z_u normal_x "
        "normal_y normal_z distance_u cos_alpha flatness_u2 patches curvature_points "
        "mean_curvature_per_u mean_curvature_sd_per_u gaussian_curvature_per_u2 "
        "gaussian_curvature_sd_per_u2 curvature_residual_u");
}

TEST_CASE("columns: what is there on demand comes last", "[columns]") {
  const auto added = [](const std::vector<MeasureColumn>& all, size_t before) {
    return names({all.begin() + std::ptrdiff_t(before), all.end()});
  };
  const size_t grains = grainColumns({}).size(), bonds = bondColumns({}).size();
  const std::string gray = "gray_voxels gray_mean gray_sd gray_min gray_max gray_median";
  CHECK(added(grainColumns({}, {true, true, true}), grains) ==
        "feret_max_u feret_min_u convex_volume_u3 solidity zingg_class " + gray + " edge_weight");
  CHECK(added(bondColumns({}, {true, true, true}), bonds) == gray);
  CHECK(added(bondColumns({}, {false, false, false, true}), bonds) ==
        "neck_area_u2 neck_radius_u neck_error_u2 neck_gap_u neck_confirmed neck_normal_x "
        "neck_normal_y neck_normal_z");
  CHECK(added(grainColumns({}, {false, false, false, false, true}), grains) ==
        "cell_volume_u3 local_solid_fraction cell_neighbors cell_at_domain_face");
  CHECK(added(grainColumns({}, {false, false, false, false, false, true}), grains) ==
        "projected_diameter_u");

  GrainMeasures grain;
  grain.volume = 6;
  grain.ellipsoid.values = {9, 4, 3};
  grain.shape = GrainShape{1, 2, 8};
  grain.gray = GrayValues{3, 4, 5, 6, 7, 7.5};
  grain.edgeWeight = 9;
  BondMeasures bond;
  bond.gray = grain.gray;
  const auto values = [](const std::vector<MeasureColumn>& columns, size_t before, size_t row) {
    std::vector<double> found;
    for (size_t i = before; i < columns.size(); ++i) found.push_back(columns[i].values.at(row));
    return found;
  };
  const auto ofGrains = grainColumns({grain, GrainMeasures()}, {true, true, true});
  CHECK(values(ofGrains, grains, 0) ==
        std::vector<double>{1, 2, 8, 0.75, 4, 3, 4, 5, 6, 7, 7.5, 9});
  CHECK(std::isnan(column(ofGrains, "feret_max").values[1]));
  CHECK(std::isnan(column(ofGrains, "gray_mean").values[1]));
  CHECK(values(bondColumns({bond}, {false, true, false}), bonds, 0) ==
        std::vector<double>{3, 4, 5, 6, 7, 7.5});
}

TEST_CASE("columns: each holds the measure of its name", "[columns]") {
  GrainMeasures grain;
  grain.id = 7;
  grain.voxels = 9007199254740991;  // the largest count that is exact
  grain.volume = double(grain.voxels);
  grain.equivalentDiameter = 1.5;
  grain.centroid = {2, 3, 4};
  grain.representative = Coord(-5, 6, 8);
  grain.inscribedRadius = 9;
  grain.freeArea = 10;
  grain.sharedArea = 11;
  grain.cutArea = 12;
  grain.sphericity = 0.5;
  grain.ellipsoid = {
      {openvdb::Vec3d(13, 14, 15), openvdb::Vec3d(16, 17, 18), openvdb::Vec3d(19, 20, 22)},
      {32, 16, 4}};
  grain.box = {Coord(-1, -2, -3), Coord(23, 24, 25)};
  grain.coordination = 26;
  grain.atDomainFace = true;
  GrainMeasures bare;  // its representative is not known
  const std::vector<MeasureColumn> grains = grainColumns({grain, bare});
  std::vector<double> row;
  for (const MeasureColumn& one : grains) {
    REQUIRE(one.values.size() == 2);
    row.push_back(one.values[0]);
  }
  CHECK(row == std::vector<double>{7,
                                   9007199254740991.,
                                   9007199254740991.,
                                   1.5,
                                   2,
                                   3,
                                   4,
                                   -5,
                                   6,
                                   8,
                                   9,
                                   21,
                                   10,
                                   11,
                                   12,
                                   0.5,
                                   32,
                                   16,
                                   4,
                                   0.5,
                                   0.25,
                                   13,
                                   14,
                                   15,
                                   16,
                                   17,
                                   18,
                                   19,
                                   20,
                                   22,
                                   -1,
                                   -2,
                                   -3,
                                   23,
                                   24,
                                   25,
                                   26,
                                   1});
  for (const char* name :
       {"representative_x", "representative_y", "representative_z", "inscribed_radius"})
    CHECK(std::isnan(column(grains, name).values[1]));

  BondMeasures bond;
  bond.first = 1;
  bond.second = 2;
  bond.faces = 3;
  bond.area = 4;
  bond.equivalentRadius = 5;
  bond.centroid = {6, 7, 8};
  bond.normal = {9, 10, 11};
  bond.distance = 12;
  bond.cosAlpha = -0.5;
  bond.flatness = 13;
  bond.patches = 14;
  bond.curvature = InterfaceCurvature{15, 16, 17, 18, 19, 20};
  const std::vector<MeasureColumn> bonds = bondColumns({bond, BondMeasures()});
  row.clear();
  std::set<std::string> unknown;
  for (const MeasureColumn& one : bonds) {
    row.push_back(one.values.at(0));
    if (std::isnan(one.values.at(1))) unknown.insert(one.name);
  }
  CHECK(row == std::vector<double>{1,  2,    3,  4,  5,  6,  7,  8,  9,  10, 11,
                                   12, -0.5, 13, 14, 15, 16, 17, 18, 19, 20});
  CHECK(unknown == std::set<std::string>{"distance", "cos_alpha", "mean_curvature",
                                         "mean_curvature_sd", "gaussian_curvature",
                                         "gaussian_curvature_sd", "curvature_residual"});
}

TEST_CASE("columns: places know their axes, what is whole is marked", "[columns]") {
  using Kind = MeasureColumn::Kind;
  const std::vector<MeasureColumn> grains = grainColumns({}), bonds = bondColumns({});
  for (const auto* columns : {&grains, &bonds})
    for (const char* axis : {"x", "y", "z"}) {
      const MeasureColumn& place = column(*columns, std::string("centroid_") + axis);
      CHECK(place.kind == MeasureColumn::Kind::place);
      CHECK(place.axis == axis[0] - 'x');
    }
  std::map<Kind, std::string> names;
  for (const auto* columns : {&grains, &bonds})
    for (const MeasureColumn& one : *columns) {
      CHECK(one.isWhole() == (one.kind != Kind::number && one.kind != Kind::place));
      names[one.kind] += one.name + " ";
    }
  CHECK(names[Kind::count] ==
        "voxels box_min_x box_min_y box_min_z box_max_x box_max_y box_max_z coordination faces "
        "patches curvature_points ");
  CHECK(names[Kind::label] == "id first second ");
  CHECK(names[Kind::flag] == "at_domain_face ");
}

TEST_CASE("columns: powers of a length", "[columns]") {
  CHECK(unitSuffix(0, "mm").empty());
  CHECK(unitSuffix(1, "mm") == "_mm");
  CHECK(unitSuffix(3, "mm") == "_mm3");
  CHECK(unitSuffix(-1, "mm") == "_per_mm");
  CHECK(unitSuffix(-2, "mm") == "_per_mm2");
  CHECK(scaled(3, 0, 0.5) == 3);
  CHECK(scaled(3, 1, 0.5) == 1.5);
  CHECK(scaled(3, 3, 0.5) == 0.375);
  CHECK(scaled(3, -1, 0.5) == 6);
  CHECK(scaled(3, -2, 0.5) == 12);
}

TEST_CASE("columns: what is given of grains comes last", "[columns]") {
  const std::string moves =
      "side,grain,fate,track,miss,turn,voxels\nbefore,3,kept,3,0.5,,10\nbefore,7,lost,7,,-2e-1,11\n"
      "after,1,kept,7,9,8,12\n";
  ExtraMeasures extra;
  extra.given = givenColumns(moves).columns;
  std::vector<GrainMeasures> grains(2);
  grains[0].id = 3;
  grains[1].id = 7;
  const auto columns = grainColumns(grains, extra);
  CHECK(columns[columns.size() - 3].name == "miss");
  CHECK(columns[columns.size() - 2].name == "turn");
  CHECK(columns.back().name == "given_voxels");  // others than those that are there
  grains[0].voxels = 10;
  grains[1].voxels = 11;
  CHECK(grainColumns(grains, extra).back().name == "turn");
  CHECK(column(columns, "miss").values[0] == 0.5);
  CHECK(std::isnan(column(columns, "miss").values[1]));
  CHECK(column(columns, "turn").values[1] == -0.2);
  CHECK(givenColumns(moves, true).columns.at(0).values == std::map<int32_t, double>{{7, 9}});
  // A column `side` is that of tracks beside their columns alone.
  CHECK(givenColumns("id,side,a\n1,left,2\n").columns.at(0).values.at(1) == 2);
  CHECK(givenColumns("grain,side,a\n1,0.5,2\n", true).columns.size() == 2);
  extra.given = givenColumns("id,given_area,area\n3,5,6\n7,8,9\n").columns;
  const auto both = grainColumns(grains, extra);
  CHECK(column(both, "given_area").values[1] == 8);
  CHECK(column(both, "given_given_area").values[1] == 9);
  CHECK(givenColumns("a,id\r\n1,2\r\n").columns.at(0).values.at(2) == 1);
  using vdb_madf::test::Contains;
  CHECK_THROWS_WITH(givenColumns(""), Contains("no column 'grain' or 'id'"));
  CHECK_THROWS_WITH(givenColumns("grain\n1\n"), Contains("no column of numbers"));
  CHECK(givenColumns("grain,a\n1,2\n\r\n\n").columns.size() == 1);  // as editors leave at the end
  CHECK_THROWS_WITH(givenColumns("grain,a\n1\n"), Contains("line 2: has 1 cell, and the first 2"));
  CHECK_THROWS_WITH(givenColumns("grain,a\n1,2,3\n"), Contains("line 2: has 3 cells"));
  CHECK_THROWS_WITH(givenColumns("grain,a\n0.5,2\n"), Contains("'0.5' is no number of a grain"));
  CHECK_THROWS_WITH(givenColumns("grain,a\n9999999999,2\n"), Contains("no number of a grain"));
  CHECK_THROWS_WITH(givenColumns("grain,a\n1,2\n1,3\n"), Contains("line 3: grain 1 comes twice"));
  CHECK_THROWS_WITH(givenColumns("grain,a\n1,\"2\n"), Contains("quotation mark"));
}

TEST_CASE("columns: tables of other programs", "[columns]") {
  const vdb_madf::GivenTable table = givenColumns(
      "\"id\",\"mean stress (MPa)\",shape,mean_stress_MPa,volume_mm3,\"a \"\"b\"\"\"\r\n"
      "\"1\",\"2.5\",\"round, flat\",1,7,NA\r\n2,NA,\"two\nlines\",1,8,3\r\n");
  REQUIRE(table.columns.size() == 3);
  CHECK(table.columns[0].name == "mean_stress_MPa");
  CHECK(table.columns[0].values == std::map<int32_t, double>{{1, 2.5}});
  CHECK(table.columns[1].name == "volume_mm3");
  CHECK(table.columns[2].name == "a_b");
  CHECK(table.columns[2].values == std::map<int32_t, double>{{2, 3}});
  CHECK(table.leftOut == std::vector<std::string>{"shape", "mean_stress_MPa"});
  CHECK(givenColumns("\xEF\xBB\xBFid,a\n1,2\n").columns.at(0).values.at(1) == 2);
  CHECK(givenColumns("id,__proto__\n1,2\n").columns.at(0).name == "proto");

  ExtraMeasures extra;
  extra.given = table.columns;
  std::vector<GrainMeasures> grains(1);
  grains[0].id = 2;
  const auto columns = grainColumns(grains, extra);
  CHECK(column(columns, "given_volume_mm3").values[0] == 8);  // `volume` has this name in mm
  // The program's own tables, in any unit and to some digits, say nothing new.
  extra.given =
      givenColumns("id,volume_mm3,equivalent_diameter_um\n2,0.012,30.00001\n3,0.03,50\n").columns;
  grains.resize(2);
  grains[1].id = 3;
  grains[0].volume = 12;
  grains[1].volume = 30;
  grains[0].equivalentDiameter = 3;
  grains[1].equivalentDiameter = 6;
  CHECK(grainColumns(grains, extra).back().name == "given_equivalent_diameter_um");
  grains[1].equivalentDiameter = 5;
  CHECK(grainColumns(grains, extra).back().name == "at_domain_face");
  // Without a unit in the name larger numbers are others, and one number tells no unit.
  extra.given = givenColumns("id,volume\n2,24\n3,60\n").columns;
  CHECK(grainColumns(grains, extra).back().name == "given_volume");
  extra.given = givenColumns("id,volume_mm3\n2,24\n").columns;
  CHECK(grainColumns(grains, extra).back().name == "given_volume_mm3");
  grains.resize(1);
  CHECK(vdb_madf::noteOnGiven(table.columns, grains) ==
        "1 of its 2 grains are not among those of the labels");
  grains[0].id = 1;
  grains.push_back(grains[0]);
  grains[1].id = 2;
  CHECK(vdb_madf::noteOnGiven(table.columns, grains).empty());
}
