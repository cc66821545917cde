// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/pictures/picture_sheet.h"

#include <algorithm>

#include "support/catch.h"
#include "vdb_madf/pictures/detail/canvas.h"
#include "vdb_madf/pictures/detail/scale_bar.h"

using namespace vdb_madf;

namespace {

int count(const Picture& picture, const Rgb& color) {
  return int(std::count(picture.pixels.begin(), picture.pixels.end(), color));
}

bool isDark(const Rgb& color) {
  return color[0] + color[1] + color[2] < 300 && color[0] == color[1] && color[1] == color[2];
}

int darkPixels(const Picture& picture) {
  return int(std::count_if(picture.pixels.begin(), picture.pixels.end(), isDark));
}

}  // namespace

TEST_CASE("picture_sheet: every panel is whole, with a scale bar where it can be", "[pictures]") {
  std::vector<PicturePanel> panels;
  for (uint8_t i = 1; i <= 3; ++i)
    panels.push_back({Picture(100 + 10 * i, 90 + i, Rgb{i, 0, 0}), i == 2 ? "" : "x-y", 0.5});
  const Picture plain = pictureSheet(panels), scaled = pictureSheet(panels, VoxelSize{1e-6});
  for (const Picture* sheet : {&plain, &scaled})
    for (uint8_t i = 1; i <= 3; ++i)
      CHECK(count(*sheet, Rgb{i, 0, 0}) == (100 + 10 * i) * (90 + i));
  CHECK(darkPixels(plain) > 10);
  CHECK(darkPixels(scaled) > darkPixels(plain) + 3 * 40);
}

TEST_CASE("picture_sheet: no text is cut off or lies on a picture", "[pictures]") {
  const std::string longest = "x-y at z = 12345 (12.3 mm)";
  for (const auto& [width, height] :
       {std::pair<int, int>{16, 16}, {40, 400}, {400, 40}, {900, 900}, {30, 2000}}) {
    CAPTURE(width, height);
    const Rgb red{255, 0, 0};
    const std::vector<PicturePanel> panels(4, {Picture(width, height, red), longest, 0.5});
    const Picture sheet = pictureSheet(panels, VoxelSize{1e-6});
    CHECK(count(sheet, red) == 4 * width * height);
    for (int x = 0; x < sheet.width; ++x)
      for (const int y : {0, 1, 2, sheet.height - 3, sheet.height - 2, sheet.height - 1})
        REQUIRE(sheet.at(x, y) == Rgb{255, 255, 255});
    for (int y = 0; y < sheet.height; ++y)
      for (const int x : {0, 1, sheet.width - 2, sheet.width - 1})
        REQUIRE(sheet.at(x, y) == Rgb{255, 255, 255});
  }
}

TEST_CASE("picture_sheet: letters grow with the pictures", "[pictures]") {
  const auto darkShare = [](int edge) {
    const Picture sheet =
        pictureSheet({{Picture(edge, edge, Rgb{200, 200, 200}), "x-y at z = 12", 1}});
    return double(darkPixels(sheet)) / double(sheet.pixels.size());
  };
  const double small = darkShare(1500), large = darkShare(4500);
  CHECK(large > 0.7 * small);
  CHECK(large < 1.4 * small);
}

TEST_CASE("picture_sheet: sheets are neither narrow nor half empty", "[pictures]") {
  for (const auto& [width, height] :
       {std::pair<int, int>{300, 300}, {100, 500}, {500, 100}, {512, 400}}) {
    CAPTURE(width, height);
    const std::vector<PicturePanel> panels(4, {Picture(width, height, Rgb{1, 0, 0}), "x-y", 1});
    const Picture sheet = pictureSheet(panels);
    const double filled = 4.0 * width * height / double(sheet.pixels.size());
    CHECK(filled > 0.6);
    CHECK(sheet.width > 0.6 * sheet.height);
    CHECK(sheet.width < 4 * sheet.height);
  }
}

TEST_CASE("scale_bar: the longest round length that fits", "[pictures]") {
  const auto bar = detail::fitScaleBar(8.5e-6, 100);  // up to 850 um
  REQUIRE(bar);
  CHECK(bar->text == "500 µm");
  CHECK(bar->pixels == Approx(500 / 8.5));
  CHECK(detail::fitScaleBar(1e-3, 1)->text == "1 mm");
  CHECK_FALSE(detail::fitScaleBar(1e-6, 0));
}

TEST_CASE("canvas: text is as wide as told and stays in its part of the picture", "[pictures]") {
  CHECK(detail::textWidth("", 20) == 0);
  CHECK(detail::textWidth("mm", 20) == Approx(2 * detail::textWidth("m", 20)));
  CHECK(detail::textWidth("10 µm", 40) == Approx(2 * detail::textWidth("10 µm", 20)));
  Picture picture(200, 60, Rgb{255, 255, 255});
  detail::paint(picture, 20, 10, 100, 40, [](detail::Canvas& canvas) {
    canvas.text({5, 30}, "HHHHHHHHHHHHHHHHHHHHHHHH", 20, {0, 0, 0});
  });
  const int whole = darkPixels(picture);
  CHECK(whole > 200);
  int inside = 0;
  for (int y = 10; y < 50; ++y)
    for (int x = 25; x < 120; ++x) inside += isDark(picture.at(x, y));
  CHECK(inside == whole);
  // What lies outside of the picture is cut off.
  detail::paint(picture, -30, -30, 300, 300, [](detail::Canvas& canvas) {
    canvas.rectangle({0, 0}, 300, 300, {1, 2, 3});
  });
  CHECK(count(picture, {1, 2, 3}) == 200 * 60);
  detail::paint(picture, 500, 0, 10, 10, [](detail::Canvas&) { FAIL("there is nothing to draw"); });
}
