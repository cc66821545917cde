// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/exports/palabos_file.h"

#include <sstream>

#include "support/catch.h"
#include "support/files.h"
#include "support/label_shapes.h"
#include "vdb_madf/base/errors.h"

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
