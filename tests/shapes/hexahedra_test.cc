// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

// The elements of larger volumes: hexahedra_file_test.cc.

#include "vdb_madf/shapes/hexahedra.h"

#include "support/catch.h"
#include "support/label_shapes.h"
#include "vdb_madf/base/errors.h"

using namespace vdb_madf;
using namespace vdb_madf::test;
using openvdb::Vec3d;

TEST_CASE("hexahedra: two voxels that share a face, across a border of leaves", "[hexahedra]") {
  const auto grid = labelGrid({{{8, 0, 0}, 2}, {{7, 0, 0}, 9}, {{7, 1, 0}, 9}});
  grid->setTransform(openvdb::math::Transform::createLinearTransform(0.5));
  const Hexahedra mesh(*grid);
  CHECK(mesh.counts().grains == 2);
  REQUIRE(mesh.counts().elements == 3);
  CHECK(mesh.counts().nodes == 16);
  std::vector<Vec3d> places;
  mesh.forEachNode([&](const Vec3d& place) { places.push_back(place); });
  REQUIRE(places.size() == 16);
  // By label, then by place; the corners in the order of VTK.
  const Coord voxels[] = {{8, 0, 0}, {7, 0, 0}, {7, 1, 0}};
  const Coord corners[] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0},
                           {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}};
  for (size_t i = 0; i < 3; ++i) {
    CHECK(mesh.label(i) == (i == 0 ? 2 : 9));
    CHECK(mesh.isFirst(i) == (i < 2));
    for (size_t n = 0; n < 8; ++n)
      CHECK(places.at(mesh.nodes(i)[n]) == 0.5 * ((voxels[i] + corners[n]).asVec3d() - Vec3d(0.5)));
  }
}

TEST_CASE("hexahedra: nothing, and too much", "[hexahedra]") {
  CHECK(Hexahedra(*labelGrid({})).counts().nodes == 0);
  auto tiled = Int32Grid::create(0);
  tiled->fill(CoordBBox(Coord(0), Coord(271)), 1);  // 272^3 > kMaxHexahedra
  CHECK_THROWS_AS(Hexahedra(*tiled), InvalidInput);
  tiled->transform().preScale(Vec3d(1, 1, 1.1));
  CHECK_THROWS_AS(Hexahedra(*tiled), InvalidInput);
}
