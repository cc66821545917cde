// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/exports/network_file.h"
#include "vdb_madf/measure/grain_network.h"

#include <tbb/global_control.h>

#include <cmath>
#include <set>

#include "support/catch.h"
#include "support/files.h"
#include "support/label_shapes.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/grids/grid_metadata.h"
#include "vdb_madf/measure/columns.h"
#include "vdb_madf/measure/measure.h"

using namespace vdb_madf;
using namespace vdb_madf::test;
using openvdb::Vec3d;

namespace {

/// Cells of a line of a .csv beside the columns: place, label twice, ends, eight other names.
constexpr size_t kCsvExtra = 3 + 2 + 2 + 9 - 1;  // one comma less

const std::vector<double>& column(const std::vector<GrainNetwork::Column>& columns,
                                  const std::string& name) {
  for (const auto& candidate : columns)
    if (candidate.name == name) return candidate.values;
  throw std::runtime_error("no column " + name);
}

size_t count(const std::string& text, const std::string& what) {
  size_t found = 0;
  for (size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + 1)) ++found;
  return found;
}

}  // namespace

TEST_CASE("grain_network: grains and bonds are those of the voxels", "[grain_network]") {
  constexpr double kVoxelEdge = 0.25;
  for (const LabelMap& voxels :
       {twoBalls({-3, 8, 5}, 6), awkwardLabels(), randomLabels(5, Coord(-6), 15, 8, 85)}) {
    const auto grid = labelGrid(voxels);
    setVoxelSize(*grid, VoxelSize{kVoxelEdge * 1e-3});
    const GrainNetwork network = grainNetwork(*grid);

    std::map<int32_t, std::vector<Vec3d>> places;
    std::map<std::pair<int32_t, int32_t>, std::vector<Vec3d>> faces;
    for (const auto& [p, label] : voxels) {
      places[label].push_back(p.asVec3d());
      for (const Coord& step : {Coord(1, 0, 0), Coord(0, 1, 0), Coord(0, 0, 1)}) {
        const auto other = voxels.find(p + step);
        if (other != voxels.end() && other->second != label)
          faces[std::minmax(label, other->second)].push_back(p.asVec3d() + step.asVec3d() / 2);
      }
    }
    const auto mean = [&](const std::vector<Vec3d>& points) {
      Vec3d sum(0);
      for (const Vec3d& p : points) sum += p;
      return kVoxelEdge * sum / double(points.size());
    };

    REQUIRE(network.grains.size() == places.size());
    std::vector<double> coordination(places.size());
    for (size_t i = 0; i < network.grains.size(); ++i) {
      const auto& own = places.at(network.grains[i]);
      CHECK((network.centers[i] - mean(own)).length() < 1e-9);
      CHECK(column(network.grainColumns, "voxels")[i] == double(own.size()));
      const double volume = double(own.size()) * std::pow(kVoxelEdge, 3);
      CHECK(column(network.grainColumns, "volume")[i] == Approx(volume));
      const double diameter = column(network.grainColumns, "equivalent_diameter")[i];
      CHECK(M_PI / 6 * std::pow(diameter, 3) == Approx(volume));
    }
    REQUIRE(network.bonds.size() == faces.size());
    size_t i = 0;
    for (const auto& [pair, own] : faces) {  // in the same order
      const auto [first, second] = network.bonds[i];
      CHECK(network.grains[first] == pair.first);
      CHECK(network.grains[second] == pair.second);
      ++coordination[first];
      ++coordination[second];
      CHECK(column(network.bondColumns, "faces")[i] == double(own.size()));
      CHECK(column(network.bondColumns, "face_area")[i] ==
            Approx(double(own.size()) * kVoxelEdge * kVoxelEdge));
      CHECK(column(network.bondColumns, "length")[i] ==
            Approx((network.centers[first] - network.centers[second]).length()));
      const Vec3d center(column(network.bondColumns, "centroid_x")[i],
                         column(network.bondColumns, "centroid_y")[i],
                         column(network.bondColumns, "centroid_z")[i]);
      CHECK((center - mean(own)).length() < 1e-9);
      ++i;
    }
    CHECK(column(network.grainColumns, "coordination") == coordination);
  }
}

TEST_CASE("grain_network: the columns are those of the tables, in their order", "[grain_network]") {
  const GrainNetwork network = grainNetwork(*labelGrid(twoBalls({-3, 8, 5}, 6)));
  const auto requireNames =
      [](const std::vector<GrainNetwork::Column>& columns, const std::vector<MeasureColumn>& tables,
         const std::set<std::string>& leftOut, const std::vector<std::string>& more) {
        std::vector<std::string> names, wanted;
        for (const auto& one : columns) names.push_back(one.name);
        for (const auto& one : tables)
          if (!leftOut.count(one.name)) wanted.push_back(one.name);
        wanted.insert(wanted.end(), more.begin(), more.end());
        CHECK(names == wanted);
      };
  requireNames(network.grainColumns, grainColumns({}), {"id"}, {});
  ExtraMeasures extra;
  extra.bondRadii = true;
  requireNames(network.bondColumns, bondColumns({}, extra), {"first", "second"},
               {"face_area", "length"});
}

TEST_CASE("grain_network: every measure is there, in world units", "[grain_network]") {
  constexpr double kVoxelEdge = 0.25;
  const auto grid = labelGrid(twoBalls({-3, 8, 5}, 6));
  const GrainNetwork plain = grainNetwork(*grid);
  const Measurements measured = measure(*grid);
  setVoxelSize(*grid, VoxelSize{kVoxelEdge * 1e-3});
  grid->transform().postTranslate(Vec3d(10, 20, 30));
  const GrainNetwork scaled = grainNetwork(*grid);

  // Powers of the length in the units.
  const std::map<std::string, int> powers{{"volume", 3},
                                          {"equivalent_diameter", 1},
                                          {"inscribed_radius", 1},
                                          {"area", 2},
                                          {"free_area", 2},
                                          {"shared_area", 2},
                                          {"cut_area", 2},
                                          {"axis1_length", 1},
                                          {"axis2_length", 1},
                                          {"axis3_length", 1},
                                          {"face_area", 2},
                                          {"radius", 1},
                                          {"distance", 1},
                                          {"flatness", 2},
                                          {"length", 1},
                                          {"mean_curvature", -1},
                                          {"mean_curvature_sd", -1},
                                          {"gaussian_curvature", -2},
                                          {"curvature_residual", 1},
                                          {"gaussian_curvature_sd", -2}};
  const auto compare = [&](const auto& one, const auto& other) {
    REQUIRE(one.size() == other.size());
    for (size_t i = 0; i < one.size(); ++i) {
      const std::string& name = one[i].name;
      CAPTURE(name);
      CHECK(other[i].name == name);
      bool isPlace = false;
      for (const char* place : {"centroid_", "representative_", "box_min_", "box_max_"})
        isPlace |= name.rfind(place, 0) == 0;
      const auto power = powers.find(name);
      for (size_t row = 0; row < one[i].values.size(); ++row) {
        double expected = one[i].values[row];
        if (isPlace) expected = kVoxelEdge * expected + 10 * (name.back() - 'w');
        if (power != powers.end()) expected *= std::pow(kVoxelEdge, power->second);
        CHECK(other[i].values[row] == Approx(expected).margin(1e-12));
      }
    }
  };
  compare(plain.grainColumns, scaled.grainColumns);
  compare(plain.bondColumns, scaled.bondColumns);

  REQUIRE(measured.grains.size() == 2);
  for (size_t i = 0; i < 2; ++i) {
    const GrainMeasures& grain = measured.grains[i];
    const auto value = [&](const std::string& name) { return column(plain.grainColumns, name)[i]; };
    CHECK(plain.grains[i] == grain.id);
    CHECK(value("representative_x") == (*grain.representative)[0]);
    CHECK(value("inscribed_radius") == grain.inscribedRadius);
    CHECK(value("area") == Approx(value("free_area") + value("shared_area")));
    CHECK(value("free_area") == grain.freeArea);
    CHECK(value("sphericity") == grain.sphericity.value());
    CHECK(value("axis2_length") == grain.ellipsoid.values[1]);
    CHECK(value("axis3_y") == grain.ellipsoid.axes[2][1]);
    CHECK(value("aspect_3_to_2") == grain.ellipsoid.values[2] / grain.ellipsoid.values[1]);
    CHECK(value("box_max_z") == grain.box.max().z());
    CHECK(value("at_domain_face") == (grain.atDomainFace ? 1 : 0));
  }
  const BondMeasures& bond = measured.bonds.at(0);
  const auto value = [&](const std::string& name) { return column(plain.bondColumns, name)[0]; };
  CHECK(value("normal_x") == Approx(1));  // the balls lie along x
  CHECK(value("area") == bond.area);
  CHECK(value("radius") == Approx(std::sqrt(bond.area / M_PI)));
  CHECK(value("distance") == *bond.distance);
  CHECK(value("cos_alpha") == *bond.cosAlpha);
  CHECK(value("inscribed_radius") > 1);
  CHECK(value("inscribed_radius") < 6);
  CHECK(value("patches") == 1);
  REQUIRE(bond.curvature);
  CHECK(value("mean_curvature") == bond.curvature->mean);
  CHECK(value("gaussian_curvature_sd") == bond.curvature->gaussianDeviation);
}

TEST_CASE("grain_network: what is not known is left out", "[grain_network]") {
  LabelMap full;  // no background: no representatives; a bond too small for curvatures
  for (int n = 0; n < 8; ++n) full[{n >> 2, n >> 1 & 1, n & 1}] = n < 4 ? 1 : 2;
  const auto grid = labelGrid(full);
  setDomain(*grid, CoordBBox(Coord(0), Coord(1)));
  const GrainNetwork network = grainNetwork(*grid);
  for (const char* name :
       {"representative_x", "representative_z", "inscribed_radius", "sphericity"})
    CHECK(std::isnan(column(network.grainColumns, name)[1]));
  for (const char* name :
       {"distance", "cos_alpha", "inscribed_radius", "mean_curvature", "curvature_residual"})
    CHECK(std::isnan(column(network.bondColumns, name)[0]));
  const ScratchFolder folder;
  for (const std::string end : {"vtp", "graphml", "csv"})
    writeNetwork(folder / ("n." + end), network);
  const std::string graphml = readFile(folder / "n.graphml"), csv = readFile(folder / "n.csv");
  // Beside the columns a grain has its id and place; it lacks five of them.
  const size_t grainData = 4 + network.grainColumns.size() - 5,
               bondData = network.bondColumns.size() - 8;
  CHECK(count(graphml, "</data>") == 2 * grainData + bondData);
  CHECK(count(csv, ",") ==
        3 * (kCsvExtra + network.grainColumns.size() + network.bondColumns.size()));
  for (const std::string& text : {graphml, csv}) CHECK(count(text, "nan") == 0);
  const GrainNetwork large = grainNetwork(*labelGrid({{Coord(0), 200000000}}));
  writeNetwork(folder / "large.csv", large);
  CHECK(count(readFile(folder / "large.csv"), ",200000000,200000000,") == 1);
}

TEST_CASE("grain_network: same for any number of threads; empty; voxels that are no cubes",
          "[grain_network]") {
  const auto grid = labelGrid(randomLabels(6, Coord(-20), 24, 30, 60));
  const GrainNetwork network = grainNetwork(*grid);
  {
    const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
    const GrainNetwork other = grainNetwork(*grid);
    CHECK(other.centers == network.centers);
    CHECK(other.bonds == network.bonds);
    const ScratchFolder folder;
    writeNetwork(folder / "one.vtp", other);
    writeNetwork(folder / "all.vtp", network);
    CHECK(readFile(folder / "one.vtp") == readFile(folder / "all.vtp"));
  }
  CHECK(grainNetwork(*labelGrid({})).grains.empty());
  grid->transform().preScale(Vec3d(1, 1, -1));
  CHECK_THROWS_AS(grainNetwork(*grid), InvalidInput);
}

TEST_CASE("grain_network: files hold every grain and every bond", "[grain_network]") {
  const ScratchFolder folder;
  const GrainNetwork network = grainNetwork(*labelGrid(randomLabels(6, Coord(-3), 8, 12, 70)));
  REQUIRE(network.bonds.size() > network.grains.size());
  for (const std::string end : {"vtp", "graphml", "csv"})
    writeNetwork(folder / ("n." + end), network);
  const std::string graphml = readFile(folder / "n.graphml"), csv = readFile(folder / "n.csv");
  CHECK(count(graphml, "<node ") == network.grains.size());
  CHECK(count(graphml, "<edge ") == network.bonds.size());
  const auto known = [](const std::vector<GrainNetwork::Column>& columns) {
    size_t result = 0;
    for (const auto& one : columns)
      for (const double value : one.values) result += !std::isnan(value);
    return result;
  };
  CHECK(count(graphml, "</data>") ==
        network.grains.size() * 4 + known(network.grainColumns) + known(network.bondColumns));
  CHECK(count(csv, "\n") == 1 + network.bonds.size());
  CHECK(count(csv, ",") == (1 + network.bonds.size()) * (kCsvExtra + network.grainColumns.size() +
                                                         network.bondColumns.size()));
  CHECK_THROWS_AS(writeNetwork(folder / "n.xyz", network), InvalidInput);
  const GrainNetwork nothing = grainNetwork(*labelGrid({}));
  for (const std::string end : {"vtp", "graphml", "csv"})
    writeNetwork(folder / ("e." + end), nothing);
  CHECK(count(readFile(folder / "e.csv"), "\n") == 1);
}
