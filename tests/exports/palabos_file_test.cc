// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/exports/palabos_file.h"

#include <sstream>

#include "support/catch.h"
#include "support/files.h"
#include "support/label_shapes.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/grids/grid_metadata.h"

using namespace vdb_madf;
using namespace vdb_madf::test;

TEST_CASE("palabos_file: fluid, walls and what lies within", "[palabos_file]") {
  const ScratchFolder folder;
  const std::string path = folder / "cells.dat";
  const CoordBBox box(Coord(-7, 3, 6), Coord(12, 14, 15));
  for (const LabelMap& voxels :
       {LabelMap{}, twoBalls({2, 9, 10}, 6), randomLabels(5, Coord(-8, 2, 6), 22, 8, 85)}) {
    writePalabos(path, *labelGrid(voxels), box);
    const auto isGrain = [&](const Coord& p) { return voxels.count(p) > 0; };
    std::istringstream file(readFile(path));
    for (auto p = box.begin(); p; ++p) {  // x slowest
      int least = 1;                      // of the neighbors
      for (int n = 0; n < 27; ++n) {
        const Coord q = (*p).offsetBy(n / 9 - 1, n / 3 % 3 - 1, n % 3 - 1);
        least = std::min(least, int(box.isInside(q) && isGrain(q)));
      }
      int cell = -1;
      REQUIRE(file >> cell);
      CHECK(cell == (isGrain(*p) ? 1 + least : 0));
    }
    int beyond = 0;
    CHECK_FALSE(file >> beyond);
  }
  CHECK_THROWS_AS(writePalabos(path, *labelGrid({}), CoordBBox()), InvalidInput);
}

TEST_CASE("palabos_file: no fluid flows outside of a region", "[palabos_file]") {
  const ScratchFolder folder;
  const std::string path = folder / "cells.dat";
  const CoordBBox box(Coord(-20, -10, 3), Coord(20, 28, 16));
  const auto isInside = [](const Coord& p) {
    const bool isInTile = (p.x() & ~7) == 0 && (p.y() & ~7) == 8 && (p.z() & ~7) == 8;
    return isInTile || p.x() * p.x() + (p.y() - 9) * (p.y() - 9) <= 50;
  };
  MaskTree region;
  region.addTile(1, Coord(0, 8, 8), true, true);
  for (auto p = box.begin(); p; ++p)
    if (isInside(*p)) region.setValueOn(*p);
  const Int32Grid::Ptr labels = labelGrid({{Coord(0, 9, 4), 1}, {Coord(1, 9, 4), 2}});
  setDomain(*labels, Domain(region));
  writePalabos(path, *labels, box);
  std::istringstream file(readFile(path));
  int inner = 0;
  for (auto p = box.begin(); p; ++p) {
    bool atFluid = false;
    for (int n = 0; n < 27; ++n) {
      const Coord q = (*p).offsetBy(n / 9 - 1, n / 3 % 3 - 1, n % 3 - 1);
      atFluid = atFluid || !box.isInside(q) || (isInside(q) && labels->tree().getValue(q) == 0);
    }
    const bool isFluid = isInside(*p) && labels->tree().getValue(*p) == 0;
    int cell = -1;
    REQUIRE(file >> cell);
    CHECK(cell == (isFluid ? 0 : atFluid ? 1 : 2));
    inner += cell == 2;
  }
  CHECK(inner > 0);
}
