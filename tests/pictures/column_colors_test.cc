// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/pictures/column_colors.h"

#include <cmath>

#include "support/catch.h"
#include "vdb_madf/base/errors.h"

using namespace vdb_madf;

namespace {

/// Grains 1 to 101 whose sphericity is a hundredth of their place, but for one that has none.
Measurements hundredGrains() {
  Measurements m;
  m.voxelSize = VoxelSize{1e-5};
  for (int i = 0; i <= 100; ++i) {
    GrainMeasures grain;
    grain.id = i + 1;
    grain.sphericity = i == 50 ? NAN : i / 100.0;
    grain.equivalentDiameter = i;
    m.grains.push_back(grain);
  }
  return m;
}

constexpr Rgb kLowest{68, 1, 84}, kHighest{253, 231, 37}, kGray{150, 150, 150};

}  // namespace

TEST_CASE("column_colors: from the first hundredth of the values to the last", "[pictures]") {
  const ColumnColors colors = columnColors(hundredGrains(), "sphericity");
  CHECK(colors.title == "sphericity");
  CHECK(colors.low == Approx(0.01));
  CHECK(colors.high == Approx(0.99));
  CHECK(colors.colors.colorOf(1) == kLowest);
  CHECK(colors.colors.colorOf(2) == kLowest);
  CHECK(colors.colors.colorOf(101) == kHighest);
  CHECK(colors.colors.colorOf(51) == kGray);
  const Rgb middle = colors.colors.colorOf(52);
  CHECK(std::abs(middle[1] - 144) < 5);
}

TEST_CASE("column_colors: lengths are in the unit of tables", "[pictures]") {
  for (const char* name : {"equivalent_diameter", "equivalent_diameter_mm"}) {
    const ColumnColors colors = columnColors(hundredGrains(), name);
    CHECK(colors.title == "equivalent_diameter_mm");
    CHECK(colors.high == Approx(0.99));
  }
  Measurements sure = hundredGrains();
  sure.extra.stability = true;
  sure.grains[3].life.stability = 0;
  sure.grains[4].life.stability = 7;
  // The others are always the same.
  const GrainColors lives = columnColors(sure, "stability").colors;
  CHECK(lives.colorOf(4) == kLowest);
  CHECK(lives.colorOf(5) == kHighest);
  CHECK(lives.colorOf(6) == kHighest);
  // All are alike.
  CHECK(columnColors(hundredGrains(), "coordination").high == 1);
  CHECK(columnColors({}, "voxels").colors.labels.empty());
  CHECK_THROWS_WITH(columnColors(hundredGrains(), "hue"),
                    vdb_madf::test::StartsWith("grains have no 'hue': there are id, voxels, "));
}

TEST_CASE("column_colors: the scale stands beside pictures, without a bar of lengths",
          "[pictures]") {
  const Rgb red{255, 0, 0};
  const PicturePanel scale = colorScalePanel(columnColors(hundredGrains(), "sphericity"), 200, red);
  CHECK(scale.picture.height == 200);
  CHECK(scale.picture.at(0, 0) == red);
  for (size_t i = 0; i < 3; ++i) {
    CHECK(std::abs(scale.picture.at(5, 11)[i] - kHighest[i]) < 6);
    CHECK(std::abs(scale.picture.at(5, 188)[i] - kLowest[i]) < 6);
  }
  const Picture sheet = pictureSheet({scale}, VoxelSize{1e-5}, red);
  CHECK(sheet.at(0, 0) == red);
  const std::vector<PicturePanel> unknown{{scale.picture, scale.caption, 0, false}};
  CHECK(pictureSheet(unknown, std::nullopt, red).pixels == sheet.pixels);
}
