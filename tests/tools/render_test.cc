// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

// What the pictures of the command show, read back from the PNG.

#include <png.h>

#include <catch2/catch.hpp>
#include <cmath>
#include <cstring>
#include <map>

#include "support/program.h"
#include "vdb_madf/pictures/picture.h"

using namespace vdb_madf;
using namespace vdb_madf::test;

namespace {

const std::string kSintered =
    "generate sintered s.vdb --size 64 --count 40 --radius 8:12 --neck 0.7 ";

Picture readPng(const std::string& bytes) {
  png_image image;
  std::memset(&image, 0, sizeof image);
  image.version = PNG_IMAGE_VERSION;
  REQUIRE(png_image_begin_read_from_memory(&image, bytes.data(), bytes.size()));
  image.format = PNG_FORMAT_RGB;
  Picture picture(int(image.width), int(image.height), {});
  REQUIRE(png_image_finish_read(&image, nullptr, picture.pixels.data(), 0, nullptr));
  return picture;
}

/// The longest row of one colour of ink, which is darker than all else outside of the parts.
int longestDarkRun(const Picture& picture, int row) {
  int longest = 0, run = 0;
  for (int x = 0; x < picture.width; ++x) {
    const Rgb& color = picture.at(x, row);
    run = color == Rgb{40, 40, 40} ? run + 1 : 0;
    longest = std::max(longest, run);
  }
  return longest;
}

}  // namespace

TEST_CASE("cli: render shows the middle slices, touching grains in unlike colours", "[cli]") {
  const Bench bench;
  bench.mustRun(kSintered);
  bench.mustRun("render s.vdb s.png --size 64 --only slices");
  const Picture picture = readPng(bench.bytes("s.png"));
  bench.mustRun("convert s.vdb labels.raw --grid truth --type int32");
  const std::string raw = bench.bytes("labels.raw");
  const auto label = [&](int x, int y, int z) {
    int32_t value = 0;
    std::memcpy(&value, raw.data() + 4 * ((z * 64 + y) * 64 + x), 4);
    return value;
  };
  // One pixel a voxel: x-y at the top left, x-z to its right, y-z below it; z is up.
  constexpr int kGap = 12, kCaption = 32, kStep = 64 + kGap;
  std::map<int32_t, Rgb> colors;
  int pairs = 0;
  for (int i = 0; i < 64; ++i)
    for (int j = 0; j < 64; ++j) {
      const std::pair<int32_t, Rgb> seen[3] = {
          {label(i, j, 31), picture.at(kGap + i, kGap + j)},
          {label(i, 31, 63 - j), picture.at(kGap + kStep + i, kGap + j)},
          {label(31, i, 63 - j), picture.at(kGap + i, kGap + kStep + kCaption + j)}};
      for (const auto& [id, color] : seen) {
        const Rgb known = colors.emplace(id, color).first->second;
        REQUIRE(known == color);  // stable: a label has one colour
      }
    }
  for (int i = 0; i < 63; ++i)
    for (int j = 0; j < 64; ++j) {
      const int32_t a = label(i, j, 31), b = label(i + 1, j, 31);
      if (!a || !b || a == b) continue;
      ++pairs;
      CHECK(colors.at(a) != colors.at(b));
    }
  CHECK(pairs > 10);
  CHECK(colors.size() > 10);
}

TEST_CASE("cli: render draws a scale bar of a round length", "[cli]") {
  const Bench bench;
  bench.mustRun(kSintered);
  bench.mustRun("render s.vdb none.png --only slices");
  const Picture none = readPng(bench.bytes("none.png"));
  bench.mustRun("convert s.vdb labels.tif --grid truth --type int32");
  for (const double size : {0.7, 8.5, 33.0}) {
    CAPTURE(size);
    bench.mustRun("convert labels.tif sized.mhd --voxel-size " + std::to_string(size) + "um");
    bench.mustRun("render sized.mhd sized.png --only slices");
    const Picture sized = readPng(bench.bytes("sized.png"));
    REQUIRE(sized.width == none.width);
    REQUIRE(sized.height == none.height);
    const int row = sized.height - 12 - 1;  // above the margin
    const int bar = longestDarkRun(sized, row);
    CHECK(longestDarkRun(none, row) < 20);
    // 64 voxels of 8 pixels each; the bar is rounded to whole pixels.
    CHECK(bar > 512 / 6);
    CHECK(bar <= 512 / 2);
    bool round = false;
    for (double length = 1; length < 1e5; length *= 10)
      for (const int digit : {1, 2, 5}) round |= std::abs(digit * length / size * 8 - bar) <= 0.5;
    CHECK(round);
  }
}

TEST_CASE("cli: labels without a voxel size are drawn with the one that is given", "[cli]") {
  const Bench bench;
  bench.mustRun("generate spheres s.vdb --size 40 --count 4 --radius 6:8 --voxel-size 8.5um");
  bench.mustRun("convert s.vdb l.npy --grid truth");
  bench.mustRun("render s.vdb with.png --size 120");
  bench.mustRun("render l.npy without.png --size 120");
  bench.mustRun("render l.npy given.png --size 120 --voxel-size 8.5um");
  CHECK(bench.bytes("given.png") == bench.bytes("with.png"));
  CHECK(bench.bytes("without.png") != bench.bytes("with.png"));
}

TEST_CASE("cli: render keeps scale bars and their texts below their own part", "[cli]") {
  const Bench bench;
  bench.mustRun(kSintered);
  bench.mustRun("convert s.vdb s.mhd --grid truth --voxel-size 8.5um");
  for (const int size : {64, 80, 128, 200}) {
    CAPTURE(size);
    bench.mustRun("render s.mhd s.png --size " + std::to_string(size) + " --only slices");
    const Picture picture = readPng(bench.bytes("s.png"));
    const int edge = 64 * (size / 64);
    REQUIRE(picture.width == 3 * 12 + 2 * edge);
    int outside = 0;
    for (int y = 12 + edge; y < 12 + edge + 32; ++y)  // the captions of the upper row
      for (const int left : {0, 12 + edge, 2 * (12 + edge)})
        for (int x = left; x < left + 12; ++x) outside += picture.at(x, y)[0] < 128;
    CHECK(outside == 0);
  }
}

TEST_CASE("cli: render draws what it is asked for", "[cli]") {
  const Bench bench;
  bench.mustRun(kSintered);
  bench.mustRun("render s.vdb all.png --size 100");
  bench.mustRun("render s.vdb view.png --size 100 --only view");
  bench.mustRun("render s.vdb turned.png --size 100 --only view --azimuth 120 --elevation -10");
  const Picture all = readPng(bench.bytes("all.png")), view = readPng(bench.bytes("view.png"));
  CHECK(all.width > 2 * 64);
  CHECK(view.width <= 100 + 2 * 12);
  CHECK(view.width > 64);
  CHECK(bench.bytes("view.png") != bench.bytes("turned.png"));
  bench.mustRun("render s.vdb again.png --size 100 --threads 1");
  CHECK(bench.bytes("again.png") == bench.bytes("all.png"));
}
