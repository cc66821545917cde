// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/pictures/png_file.h"

#include <png.h>

#include <cstring>
#include <random>
#include <vector>

#include "support/catch.h"
#include "support/files.h"
#include "vdb_madf/base/errors.h"

using namespace vdb_madf;
using namespace vdb_madf::test;

TEST_CASE("png_file: a picture is read back as it was", "[png_file]") {
  const ScratchFolder folder;
  std::mt19937 random(1);
  for (const auto& [width, height] : {std::pair<int, int>{1, 1}, {7, 3}, {300, 200}}) {
    Picture picture(width, height, Rgb{});
    for (Rgb& pixel : picture.pixels)
      for (uint8_t& channel : pixel) channel = uint8_t(random());
    writePng(folder / "a.png", picture);
    const std::string bytes = readFile(folder / "a.png");
    png_image image;
    std::memset(&image, 0, sizeof image);
    image.version = PNG_IMAGE_VERSION;
    REQUIRE(png_image_begin_read_from_memory(&image, bytes.data(), bytes.size()));
    REQUIRE(int(image.width) == width);
    REQUIRE(int(image.height) == height);
    image.format = PNG_FORMAT_RGB;
    Picture read(width, height, Rgb{});
    REQUIRE(png_image_finish_read(&image, nullptr, read.pixels.data(), 0, nullptr));
    CHECK(read.pixels == picture.pixels);
    CHECK(readFile(folder / "a.png").substr(37, 12) ==
          std::string("pHYs\0\0\x2e\x23\0\0\x2e\x23", 12));  // 11811 pixels a meter: 300 dpi
  }
}

TEST_CASE("png_file: what was drawn on white and on black shows what lies below it", "[png_file]") {
  // Nothing, all, half of a color.
  Picture onWhite(3, 1, Rgb{255, 255, 255}), onBlack(3, 1, Rgb{0, 0, 0});
  onWhite.at(1, 0) = onBlack.at(1, 0) = Rgb{10, 20, 255};
  onWhite.at(2, 0) = Rgb{227, 177, 127};
  onBlack.at(2, 0) = Rgb{100, 50, 0};
  const std::string bytes = pngBytes(onWhite, onBlack);
  png_image image;
  std::memset(&image, 0, sizeof image);
  image.version = PNG_IMAGE_VERSION;
  REQUIRE(png_image_begin_read_from_memory(&image, bytes.data(), bytes.size()));
  image.format = PNG_FORMAT_RGBA;
  std::vector<int> read;
  std::vector<uint8_t> pixels(12);
  REQUIRE(png_image_finish_read(&image, nullptr, pixels.data(), 0, nullptr));
  read.assign(pixels.begin(), pixels.end());
  CHECK(read == std::vector<int>{0, 0, 0, 0, 10, 20, 255, 255, 199, 100, 0, 128});
}

TEST_CASE("png_file: nothing is left where it cannot be written", "[png_file]") {
  const ScratchFolder folder;
  CHECK_THROWS_AS(writePng(folder / "none/a.png", Picture(2, 2, Rgb{})), IoError);
  CHECK_THROWS_AS(writePng(folder / "b.png", Picture(0, 0, Rgb{})), IoError);
  CHECK(folder.fileCount() == 0);
}
