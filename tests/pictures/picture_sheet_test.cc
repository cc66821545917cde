// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/pictures/picture_sheet.h"

#include <algorithm>
#include <catch2/catch.hpp>

#include "vdb_madf/pictures/detail/bitmap_font.h"
#include "vdb_madf/pictures/detail/scale_bar.h"

using namespace vdb_madf;

namespace {

int count(const Picture& picture, const Rgb& color) {
  return int(std::count(picture.pixels.begin(), picture.pixels.end(), color));
}

}  // namespace

TEST_CASE("picture_sheet: every panel is whole, with a scale bar where it can be", "[pictures]") {
  std::vector<PicturePanel> panels;
  for (uint8_t i = 1; i <= 3; ++i)
    panels.push_back({Picture(100 + 10 * i, 90 + i, Rgb{i, 0, 0}), i == 2 ? "" : "x-y", 0.5});
  const Picture plain = pictureSheet(panels), scaled = pictureSheet(panels, VoxelSize{1e-6});
  for (const Picture* sheet : {&plain, &scaled}) {
    CHECK(sheet->width == 12 + 130 + 12 + 120 + 12);
    CHECK(sheet->height == 12 + 92 + 32 + 12 + 93 + 32 + 12);
    for (uint8_t i = 1; i <= 3; ++i)
      CHECK(count(*sheet, Rgb{i, 0, 0}) == (100 + 10 * i) * (90 + i));
  }
  const Rgb ink{40, 40, 40};
  CHECK(count(plain, ink) > 0);
  CHECK(count(scaled, ink) > count(plain, ink));
}

TEST_CASE("picture_sheet: coarsened pixels are rounded means", "[pictures]") {
  Picture fine(5, 4, Rgb{0, 0, 0});
  fine.at(0, 0) = {255, 1, 0};
  fine.at(1, 1) = {255, 1, 3};
  fine.at(4, 0) = {99, 99, 99};  // left over
  const Picture coarse = coarsened(fine, 2);
  REQUIRE(coarse.width == 2);
  REQUIRE(coarse.height == 2);
  CHECK(coarse.at(0, 0) == Rgb{128, 1, 1});
  CHECK(coarse.at(1, 0) == Rgb{0, 0, 0});
}

TEST_CASE("scale_bar: the longest round length that fits", "[pictures]") {
  const auto bar = detail::fitScaleBar(8.5e-6, 100);  // up to 850 um
  REQUIRE(bar);
  CHECK(bar->text == "500 um");
  CHECK(bar->pixels == 59);
  CHECK(detail::fitScaleBar(1e-3, 1)->text == "1 mm");
  CHECK_FALSE(detail::fitScaleBar(1e-6, 0));
}

TEST_CASE("bitmap_font: text is as wide as told and stays in the picture", "[pictures]") {
  CHECK(detail::textWidth("", 2) == 0);
  CHECK(detail::textWidth("10 um", 2) == (5 * 6 - 1) * 2);
  Picture picture(29, 7, Rgb{});
  const Rgb ink{1, 2, 3};
  detail::drawText(picture, 0, 0, "xxxxx", ink, 1);
  const auto inked = [&](int x) {
    for (int y = 0; y < 7; ++y)
      if (picture.at(x, y) == ink) return true;
    return false;
  };
  CHECK(inked(0));
  CHECK_FALSE(inked(5));
  CHECK(inked(28));
  detail::drawText(picture, 20, -3, "888", ink, 3);  // cut off
}
