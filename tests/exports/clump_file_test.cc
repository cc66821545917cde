// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/exports/clump_file.h"

#include <sstream>
#include <string>
#include <vector>

#include "support/catch.h"
#include "support/files.h"
#include "support/label_shapes.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/grids/grid_metadata.h"

using namespace vdb_madf;
using namespace vdb_madf::test;

TEST_CASE("clumps: bonds join the nearest balls, and stand in both files", "[clumps]") {
  const ScratchFolder folder;
  const std::vector<Clump> made = {
      {2, {{Coord(0), 4}, {Coord(4, 0, 0), 4}, {Coord(-4, 0, 0), 9}}, 30, 3, 1, 0.25},
      {5, {}, 1, 1, 0, 0},
      {6, {{Coord(9, 0, 0), 4}, {Coord(0, 5, 0), 4}}, 50, 0, 0, 0}};
  BondMeasures measures, lost;
  measures.first = lost.first = 2;
  measures.second = 6;
  lost.second = 5;  // has no balls
  measures.area = 12;
  measures.equivalentRadius = 2;
  measures.centroid = openvdb::Vec3d(6, 1, 0);
  measures.normal = openvdb::Vec3d(1, 0, 0);
  const auto transform = openvdb::math::Transform::createLinearTransform(0.5);
  const auto bonds = clumpBonds(made, {lost, measures}, *transform);
  REQUIRE(bonds.size() == 1);  // balls 1 and 3 are 1 voxel apart, and so are 0 and 4: the first
  writeClumpBonds(folder / "b.csv", bonds, *transform);
  CHECK(readFile(folder / "b.csv") ==
        "bond,first,second,first_clump,second_clump,first_ball,second_ball,distance,"
        "area,radius,centroid_x,centroid_y,centroid_z,normal_x,normal_y,normal_z\n"
        "1,2,6,0,1,0,4,2.5,3,1,3,0.5,0,1,0,0\n");  // a clump without balls has no number
  writeClumps(folder / "c.data", made, *transform, bonds);
  const std::string data = readFile(folder / "c.data");
  CHECK(data.find("5 atoms\n1 atom types\n1 bonds\n1 bond types\n\n") != std::string::npos);
  CHECK(data.substr(data.find("\nBonds")) == "\nBonds\n\n1 1 1 5\n");
  writeClumps(folder / "d.data", made, *transform);
  CHECK(readFile(folder / "d.data").find("ond") == std::string::npos);
  writeClumpCover(folder / "cover.csv", made, *transform);
  CHECK(readFile(folder / "cover.csv") ==
        "grain_id,voxels,balls,uncovered,outside,volume_error,farthest\n"
        "2,30,3,3,1,-0.06666666666666667,0.125\n5,1,0,1,0,-1,\n6,50,2,0,0,0,0\n");
  CHECK(describeClumps(made, true) ==
        "3 grains, 5 balls; uncovered 4.94 %, outside the own grain 1.23 %, volume error -3.70 %, "
        "farthest voxel 0.25 voxels from its balls; 1 grain without a ball");
  CHECK_THROWS_AS(writeClumpBonds(folder / "b.txt", bonds, *transform), InvalidInput);
  CHECK_THROWS_AS(writeClumpCover(folder / "b.txt", made, *transform), InvalidInput);
}

TEST_CASE("clumps: files hold every ball at its place in the world", "[clumps]") {
  const ScratchFolder folder;
  const std::vector<Clump> made = {{5, {{Coord(1, 2, 3), 4}, {Coord(4, 2, 3), 1}}, 30, 0, 0, 0},
                                   {9, {{Coord(-8, 0, 0), 9}}, 50, 0, 0, 0}};
  const auto transform = openvdb::math::Transform::createLinearTransform(0.5);
  writeClumps(folder / "c.csv", made, *transform);
  CHECK(readFile(folder / "c.csv") ==
        "grain_id,x,y,z,radius\n5,0.5,1,1.5,1\n5,2,1,1.5,0.5\n9,-4,0,0,1.5\n");
  writeClumps(folder / "c.txt", made, *transform);
  CHECK(readFile(folder / "c.txt") ==
        "#format x_y_z_r_clumpId\n0.5 1 1.5 1 0\n2 1 1.5 0.5 0\n-4 0 0 1.5 1\n");
  writeClumps(folder / "c.data", made, *transform);
  const std::string data = readFile(folder / "c.data");
  CHECK(data.find("4 atoms\n1 atom types\n\n-5.5 2.5 xlo xhi\n") != std::string::npos);
  std::istringstream atoms(data.substr(data.find("molecular\n\n") + 11));
  // Number, type, place, diameter, density, molecule. A grain's balls weigh what its voxels do; a
  // single one has another in it, for LAMMPS takes no body of one atom.
  const double kBall = 4.0 / 3.0 * 3.14159265358979323846;
  const double first = 30 / (9 * kBall), second = 50 / ((27 + 27.0 / 8) * kBall);
  for (const double wanted : {1., 1., 0.5,      1., 1.5, 2.,  first,  1.,  //
                              2., 1., 2.,       1., 1.5, 1.,  first,  1.,  //
                              3., 1., -4.,      0., 0.,  3.,  second, 2.,  //
                              4., 1., -3.90625, 0., 0.,  1.5, second, 2.}) {
    double found = -1;
    atoms >> found;
    CHECK(found == Approx(wanted));
  }
  CHECK_THROWS_AS(writeClumps(folder / "c.xyz", made, *transform), InvalidInput);
  // Of unequal voxels: lengths in shortest edges, places along three.
  const auto flat = labelGrid({});
  setProportions(*flat, {0.5, 1, 2});
  writeClumps(folder / "f.csv", made, flat->transform());
  CHECK(readFile(folder / "f.csv") ==
        "grain_id,x,y,z,radius\n5,0.5,2,6,1\n5,2,2,6,0.5\n9,-4,0,0,1.5\n");
  writeClumps(folder / "f.data", made, flat->transform());
  const std::string flatData = readFile(folder / "f.data");
  std::istringstream line(flatData.substr(flatData.find("molecular\n\n") + 11));
  double density = -1;  // the seventh number: a voxel holds 1 * 2 * 4 cubes of the shortest edge
  for (int i = 0; i < 7; ++i) line >> density;
  CHECK(density == Approx(8 * first));
}
