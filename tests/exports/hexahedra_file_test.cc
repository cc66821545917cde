// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/exports/hexahedra_file.h"
#include "vdb_madf/labels/grain_name.h"

#include <tbb/global_control.h>

#include <sstream>

#include "support/catch.h"
#include "support/files.h"
#include "support/label_shapes.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/exports/mesh_file.h"
#include "vdb_madf/grids/grid_metadata.h"

using namespace vdb_madf;
using namespace vdb_madf::test;
using openvdb::Vec3d;

namespace {

constexpr double kEdge = 0.25;

struct Element {
  std::string set;
  std::vector<size_t> nodes;
};
struct Mesh {
  std::vector<Vec3d> nodes;
  std::vector<Element> elements;
  std::map<std::string, std::set<size_t>> faces;
};

/// The keywords and lines that we write; numbers must count from 1.
Mesh readInp(const std::string& path) {
  Mesh mesh;
  std::istringstream file(readFile(path));
  std::string set, face;
  for (std::string line; std::getline(file, line);) {
    const std::string header = "*ELEMENT, TYPE=C3D8, ELSET=", faceHeader = "*NSET, NSET=";
    if (line.rfind(faceHeader, 0) == 0) face = line.substr(faceHeader.size());
    if (line.rfind(header, 0) == 0) set = line.substr(header.size());
    if (line[0] == '*') continue;
    for (char& c : line)
      if (c == ',') c = ' ';
    std::istringstream numbers(line);
    size_t number = 0, node = 0;
    if (!face.empty()) {
      while (numbers >> node) CHECK(mesh.faces[face].insert(node - 1).second);
      continue;
    }
    numbers >> number;
    if (set.empty()) {
      Vec3d place;
      numbers >> place[0] >> place[1] >> place[2];
      mesh.nodes.push_back(place);
      REQUIRE(number == mesh.nodes.size());
    } else {
      mesh.elements.push_back({set, {}});
      while (numbers >> node) mesh.elements.back().nodes.push_back(node - 1);
      REQUIRE(number == mesh.elements.size());
    }
  }
  return mesh;
}

}  // namespace

TEST_CASE("hexa_file: a cube for each voxel, corners shared", "[hexa_file]") {
  const ScratchFolder folder;
  for (const LabelMap& voxels : {LabelMap{{Coord(-1, 7, 15), 70000}}, twoBalls({-3, 8, 5}, 6),
                                 awkwardLabels(), randomLabels(5, Coord(-6), 17, 8, 40)}) {
    const auto grid = labelGrid(voxels);
    setVoxelSize(*grid, VoxelSize{kEdge * 1e-3});
    const HexahedraCounts counts = writeHexahedra(folder / "h.inp", *grid);
    const Mesh mesh = readInp(folder / "h.inp");

    std::set<std::string> sets;
    std::set<Coord> seen;
    std::set<size_t> used;
    REQUIRE(mesh.elements.size() == voxels.size());
    for (const Element& element : mesh.elements) {
      REQUIRE(element.nodes.size() == 8);
      Vec3d middle(0);
      for (const size_t node : element.nodes) {
        middle += mesh.nodes.at(node) / 8;
        used.insert(node);
      }
      const Coord voxel = Coord::round(middle / kEdge);
      CHECK((voxel.asVec3d() * kEdge - middle).length() < 1e-12);
      seen.insert(voxel);
      sets.insert(element.set);
      REQUIRE(voxels.count(voxel));
      CHECK(element.set == grainName(voxels.at(voxel)));
      // C3D8: around the lower face, then the upper one.
      const double h = kEdge / 2;
      const Vec3d corners[8] = {{-h, -h, -h}, {h, -h, -h}, {h, h, -h}, {-h, h, -h},
                                {-h, -h, h},  {h, -h, h},  {h, h, h},  {-h, h, h}};
      for (size_t i = 0; i < 8; ++i)
        CHECK((mesh.nodes[element.nodes[i]] - middle - corners[i]).length() < 1e-12);
    }
    std::set<Coord> corners;
    for (const auto& [p, label] : voxels)
      for (int n = 0; n < 8; ++n) corners.insert(p.offsetBy(n >> 2, n >> 1 & 1, n & 1));
    CHECK(seen.size() == voxels.size());
    REQUIRE(mesh.faces.size() == 6);
    for (int axis = 0; axis < 3; ++axis)
      for (const bool isMax : {false, true}) {
        std::set<size_t> outermost;
        double plane = mesh.nodes.front()[axis];
        for (const Vec3d& node : mesh.nodes)
          plane = isMax ? std::max(plane, node[axis]) : std::min(plane, node[axis]);
        for (size_t i = 0; i < mesh.nodes.size(); ++i)
          if (mesh.nodes[i][axis] == plane) outermost.insert(i);
        const std::string name = std::string("face_") + "xyz"[axis] + (isMax ? "_max" : "_min");
        CHECK(mesh.faces.at(name) == outermost);
      }
    CHECK(mesh.nodes.size() == corners.size());
    CHECK(used.size() == corners.size());
    CHECK(counts.nodes == corners.size());
    CHECK(counts.elements == voxels.size());
    CHECK(counts.grains == volumes(voxels).size());
    CHECK(sets.size() == counts.grains);
  }
}

TEST_CASE("hexa_file: threads, tiles, empty, limits", "[hexa_file]") {
  const ScratchFolder folder;
  const auto grid = labelGrid(randomLabels(6, Coord(-20), 24, 30, 60));
  for (const std::string end : {"vtu", "inp"}) {
    writeHexahedra(folder / ("all." + end), *grid);
    const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
    writeHexahedra(folder / ("one." + end), *grid);
    CHECK(readFile(folder / ("all." + end)) == readFile(folder / ("one." + end)));
    CHECK(writeHexahedra(folder / ("e." + end), *labelGrid({})).nodes == 0);
  }
  const auto tile = Int32Grid::create(0);
  tile->fill(CoordBBox(Coord(0), Coord(7)), 5);
  const HexahedraCounts counts = writeHexahedra(folder / "t.inp", *tile);
  CHECK(counts.elements == 512);
  CHECK(counts.nodes == 729);

  CHECK_THROWS_AS(writeHexahedra(folder / "h.vtk", *grid), InvalidInput);
  tile->fill(CoordBBox(Coord(0), Coord(271)), 5);  // 20,123,648 voxels
  CHECK_THROWS_WITH(writeHexahedra(folder / "many.vtu", *tile),
                    vdb_madf::test::Contains("make the labels smaller"));
  CHECK(!std::filesystem::exists(folder / "many.vtu"));
  grid->transform().preShear(0.1, openvdb::math::X_AXIS, openvdb::math::Y_AXIS);
  CHECK_THROWS_AS(writeHexahedra(folder / "h.vtu", *grid), InvalidInput);
}
