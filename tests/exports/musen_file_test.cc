// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/exports/musen_file.h"

#include "support/catch.h"
#include "support/files.h"
#include "support/label_shapes.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/exports/network_file.h"
#include "vdb_madf/grids/grid_metadata.h"

using namespace vdb_madf;
using namespace vdb_madf::test;

TEST_CASE("musen_file: spheres and bonds, in meters, by the numbers of labels", "[musen_file]") {
  const ScratchFolder folder;
  GrainNetwork network;
  network.unit = "mm";
  network.grains = {3, 70000};
  network.centers = {{1, 2, 3}, {1, 2, -1}};
  network.bonds = {{0, 1}};
  network.grainColumns = {{"equivalent_diameter", {4, 0.5}}};
  network.bondColumns = {{"radius", {0.25}}, {"length", {4}}};
  const std::string wanted =
      "22 -0.001 0 -0.00125 0.003 0.004 0.005\n32 GRAIN grain\n32 BOND bond\n"
      "0 3 1 1 5 0.002 0.002 23 GRAIN 24 0 1e+300 2 0 12 0.001 0.002 0.003 31 1 0 0 0\n"
      "0 70000 1 1 5 0.00025 0.00025 23 GRAIN 24 0 1e+300 2 0 12 0.001 0.002 -0.001 31 1 0 0 0\n"
      "0 70001 1 9 5 3 70000 0.0005 0.004 23 BOND 24 0 1e+300 2 0\n";
  writeMusen(folder / "scene.txt", network);
  CHECK(readFile(folder / "scene.txt") == wanted);
  writeNetwork(folder / "again.txt", network);
  CHECK(readFile(folder / "again.txt") == wanted);
  writeMusen(folder / "none.txt", grainNetwork(*[] {
               const auto grid = labelGrid({});
               setVoxelSize(*grid, VoxelSize(1e-5));
               setDomain(*grid, cube(4));
               return grid;
             }()));
  CHECK(readFile(folder / "none.txt") == "32 GRAIN grain\n32 BOND bond\n");
  network.unit = "";
  CHECK_THROWS_AS(writeMusen(folder / "scene.txt", network), InvalidInput);
  network.unit = "um";
  network.bondColumns.pop_back();
  CHECK_THROWS_AS(writeMusen(folder / "scene.txt", network), InvalidInput);
}

TEST_CASE("musen_file: networks know their unit", "[musen_file]") {
  const auto grid = labelGrid(twoBalls(Coord(20), 6));
  CHECK(grainNetwork(*grid).unit.empty());
  setVoxelSize(*grid, VoxelSize(1e-5));
  CHECK(grainNetwork(*grid).unit == "mm");
  setVoxelSize(*grid, VoxelSize(1e-8));
  CHECK(grainNetwork(*grid).unit == "um");
}
