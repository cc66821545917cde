// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/measure/grain_sizes.h"

#include <cmath>

#include "support/catch.h"

using namespace vdb_madf;

namespace {

double diameter(double voxels) {
  return std::cbrt(6 * voxels / M_PI);
}

}  // namespace

TEST_CASE("grain_sizes: diameters are by volume", "[grain_sizes]") {
  // 10 % of the volume lies in the two grains of 50 voxels, 40 % in the one of 400, 50 % in that of
  // 500.
  const GrainSizes sizes = grainSizes({500, 50, 400, 50});
  CHECK(sizes.d10 == diameter(50));
  CHECK(sizes.d50 == diameter(400));
  CHECK(sizes.d90 == diameter(500));
  CHECK(sizes.dustGrains == 2);
  CHECK(sizes.dustVoxels == 100);
}

TEST_CASE("grain_sizes: a grain of 100 voxels is no dust, and there may be none", "[grain_sizes]") {
  CHECK(grainSizes({100, 99}).dustGrains == 1);
  CHECK(grainSizes({100, 99}).dustVoxels == 99);
  CHECK(grainSizes({}).dustGrains == 0);
  CHECK(std::isnan(grainSizes({}).d50));
}
