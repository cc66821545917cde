// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/grain_network.h"

#include <tbb/global_control.h>

#include <catch2/catch.hpp>
#include <cmath>
#include <set>

#include "support/files.h"
#include "support/label_shapes.h"
#include "vdb_madf/errors.h"
#include "vdb_madf/grid_metadata.h"

using namespace vdb_madf;
using namespace vdb_madf::test;
using openvdb::Vec3d;

namespace {

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
  constexpr double kEdge = 0.25;
  for (const LabelMap& voxels :
       {twoBalls({-3, 8, 5}, 6), awkwardLabels(), randomLabels(5, Coord(-6), 15, 8, 85)}) {
    const auto grid = labelGrid(voxels);
    setVoxelSize(*grid, VoxelSize{kEdge * 1e-3});
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
      return kEdge * sum / double(points.size());
    };

    REQUIRE(network.grains.size() == places.size());
    std::vector<double> coordination(places.size());
    for (size_t i = 0; i < network.grains.size(); ++i) {
      const auto& own = places.at(network.grains[i]);
      CHECK((network.centers[i] - mean(own)).length() < 1e-9);
      CHECK(column(network.grainColumns, "voxels")[i] == double(own.size()));
      const double volume = double(own.size()) * std::pow(kEdge, 3);
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
            Approx(double(own.size()) * kEdge * kEdge));
      CHECK(column(network.bondColumns, "length")[i] ==
            Approx((network.centers[first] - network.centers[second]).length()));
      const Vec3d center(column(network.bondColumns, "center_x")[i],
                         column(network.bondColumns, "center_y")[i],
                         column(network.bondColumns, "center_z")[i]);
      CHECK((center - mean(own)).length() < 1e-9);
      ++i;
    }
    CHECK(column(network.grainColumns, "coordination") == coordination);
  }
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
  }
  CHECK(grainNetwork(*labelGrid({})).grains.empty());
  grid->transform().preScale(Vec3d(1, 1, 1.1));
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
  CHECK(count(graphml, "</data>") == network.grains.size() * 8 + network.bonds.size() * 6);
  CHECK(count(csv, "\n") == 1 + network.bonds.size());
  CHECK(count(csv, ",") == (1 + network.bonds.size()) * 15);
  CHECK_THROWS_AS(writeNetwork(folder / "n.xyz", network), InvalidInput);
  const GrainNetwork nothing = grainNetwork(*labelGrid({}));
  for (const std::string end : {"vtp", "graphml", "csv"})
    writeNetwork(folder / ("e." + end), nothing);
  CHECK(count(readFile(folder / "e.csv"), "\n") == 1);
}
