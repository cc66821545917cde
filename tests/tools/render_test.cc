// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

// What the pictures of the command show, read back from the PNG.

#include <png.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>
#include <string>
#include <vector>

#include "support/catch.h"
#include "support/command_runs.h"
#include "support/program.h"
#include "vdb_madf/grids/grid_types.h"
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

constexpr Rgb kWhite{255, 255, 255}, kFrame{190, 194, 200}, kInk{40, 40, 40};

/// The parts of a sheet that have a frame, in reading order: the pixels within.
std::vector<CoordBBox> framedParts(const Picture& sheet) {
  std::vector<CoordBBox> parts;
  const auto at = [&](int x, int y) {
    return x < 0 || y < 0 || x >= sheet.width || y >= sheet.height ? kWhite : sheet.at(x, y);
  };
  for (int y = 0; y < sheet.height; ++y)
    for (int x = 0; x < sheet.width; ++x) {
      const bool isCorner = at(x, y) == kFrame && at(x + 1, y) == kFrame &&
                            at(x, y + 1) == kFrame && at(x - 1, y) == kWhite &&
                            at(x, y - 1) == kWhite;
      if (!isCorner) continue;
      int right = x, bottom = y;
      while (at(right + 1, y) == kFrame) ++right;
      while (at(x, bottom + 1) == kFrame) ++bottom;
      parts.emplace_back(Coord(x + 1, y + 1, 0), Coord(right - 1, bottom - 1, 0));
    }
  return parts;
}

/// The longest row of ink in the picture.
int longestBar(const Picture& picture) {
  int longest = 0;
  for (int y = 0; y < picture.height; ++y)
    for (int x = 0, run = 0; x < picture.width; ++x) {
      run = picture.at(x, y) == kInk ? run + 1 : 0;
      longest = std::max(longest, run);
    }
  return longest;
}

}  // namespace

TEST_CASE("cli: render writes a PNG", "[cli]") {
  const Bench bench;
  bench.mustRun(kSpheres + "s.vdb");
  bench.mustRun("render s.vdb s.png");
  const std::string png = bench.bytes("s.png");
  REQUIRE(png.size() > 33);
  CHECK(png.substr(0, 8) == "\x89PNG\r\n\x1a\n");
  CHECK(png.substr(12, 4) == "IHDR");
  const auto number = [&](size_t at) {
    uint32_t value = 0;
    for (size_t i = 0; i < 4; ++i) value = value << 8 | uint8_t(png[at + i]);
    return value;
  };
  CHECK(number(16) >= 2 * 480);  // two columns, 12 pixels a voxel
  CHECK(number(20) >= 2 * 480);
  bench.mustRun("render s.vdb t.png --threads 1");
  CHECK(bench.bytes("t.png") == png);
}

TEST_CASE("cli: render shows the middle slices, touching grains in unlike colors", "[cli]") {
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
  // One pixel a voxel; x-y, x-z, y-z; z is up.
  const std::vector<CoordBBox> parts = framedParts(picture);
  REQUIRE(parts.size() == 3);
  std::map<int32_t, Rgb> colors;
  int pairs = 0;
  for (int i = 0; i < 64; ++i)
    for (int j = 0; j < 64; ++j) {
      const auto pixel = [&](size_t part) {
        return picture.at(parts[part].min().x() + i, parts[part].min().y() + j);
      };
      const std::pair<int32_t, Rgb> seen[3] = {{label(i, j, 31), pixel(0)},
                                               {label(i, 31, 63 - j), pixel(1)},
                                               {label(31, i, 63 - j), pixel(2)}};
      for (const auto& [id, color] : seen) {
        const Rgb known = colors.emplace(id, color).first->second;
        REQUIRE(known == color);  // stable: a label has one color
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
  CHECK(longestBar(readPng(bench.bytes("none.png"))) < 20);
  bench.mustRun("convert s.vdb labels.tif --grid truth --type int32");
  for (const double size : {0.7, 8.5, 33.0}) {
    CAPTURE(size);
    bench.mustRun("convert labels.tif sized.mhd --voxel-size " + std::to_string(size) + "um");
    bench.mustRun("render sized.mhd sized.png --only slices");
    const int bar = longestBar(readPng(bench.bytes("sized.png")));
    // 64 voxels of 8 pixels each; the bar is rounded to whole pixels.
    CHECK(bar > 512 / 8);
    CHECK(bar <= 512 / 3);
    bool round = false;
    for (double length = 1; length < 1e5; length *= 10)
      for (const int digit : {1, 2, 5}) round |= std::abs(digit * length / size * 8 - bar) <= 0.5;
    CHECK(round);
  }
}

TEST_CASE("cli: render shows the slices and grains that are asked for", "[cli]") {
  const Bench bench;
  bench.mustRun(kSintered);
  bench.mustRun("render s.vdb s.png --size 64 --only slices --slice z=10,x=5,z=63,y=0,y=1");
  CHECK(framedParts(readPng(bench.bytes("s.png"))).size() == 5);
  bench.mustRun("render s.vdb all.png --size 64");
  bench.mustRun("render s.vdb some.png --size 64 --select 3,1");
  bench.mustRun("render s.vdb faces.png --size 64 --interfaces");
  bench.mustRun("render s.vdb bare.png --size 64 --no-axes");
  const std::string all = bench.bytes("all.png");
  for (const char* name : {"some.png", "faces.png", "bare.png"}) CHECK(bench.bytes(name) != all);
  for (const char* wrong :
       {"--slice 10", "--slice z=1.5", "--slice w=3", "--slice z=,x=3", "--select 0", "--select a",
        "--select 1,,2", "--only view --slice z=3", "--size 8192 --slice x=1,x=2,x=3,x=4",
        "--only view --overlay s.vdb", "--overlay-grid truth"})
    CHECK(bench.run(std::string("render s.vdb w.png ") + wrong).exitCode == 2);
  for (const char* wrong : {"--slice z=64", "--slice x=-1", "--select 4000"})
    CHECK(bench.run(std::string("render s.vdb w.png ") + wrong).exitCode == 1);
}

TEST_CASE("cli: render draws outlines of grains on the gray scan", "[cli]") {
  const Bench bench;
  bench.mustRun(kSintered);
  // The scan: what is object, as values 0 and 1.
  bench.mustRun("convert s.vdb scan.tif --grid object");
  bench.mustRun("render s.vdb o.png --size 256 --only slices --slice z=31 --overlay scan.tif");
  const Picture picture = readPng(bench.bytes("o.png"));
  const std::vector<CoordBBox> parts = framedParts(picture);
  REQUIRE(parts.size() == 1);
  int black = 0, white = 0, colored = 0;
  for (auto p = parts[0].begin(); p; ++p) {
    const Rgb& c = picture.at((*p).x(), (*p).y());
    black += c == Rgb{0, 0, 0};
    white += c == kWhite;
    colored += c[0] != c[1] || c[1] != c[2];
  }
  const int pixels = 256 * 256;
  CHECK(black > pixels / 10);
  CHECK(white > pixels / 10);
  CHECK(colored > pixels / 50);
  CHECK(colored < pixels / 2);
  bench.mustRun("generate spheres small.tif --size 32 --count 2 --radius 6:8");
  const auto refused = bench.run("render s.vdb w.png --overlay small.tif");
  CHECK(refused.exitCode == 1);
  CHECK_THAT(refused.err, vdb_madf::test::Contains("small.tif: has 32x32x32 voxels"));
  CHECK(bench.run("render s.vdb w.png --overlay missing.tif").exitCode == 1);
}

TEST_CASE("cli: report takes the scans that render takes", "[cli]") {
  const Bench bench;
  bench.mustRun(kSintered);
  bench.mustRun("generate spheres small.tif --size 32 --count 2 --radius 6:8");
  for (const std::string scan : {"small.tif", "missing.tif", "s.vdb --overlay-grid no"}) {
    const auto drawn = bench.run("render s.vdb w.png --overlay " + scan);
    const auto written = bench.run("report s.vdb r.html --overlay " + scan);
    CHECK(written.exitCode == 1);
    CHECK(written.err == drawn.err);
  }
  CHECK(bench.names().count("r.html") == 0);
  if (bench.run("report s.vdb r.html --no-3d").exitCode != 0) return;  // no esbuild
  bench.mustRun("report s.vdb o.html --no-3d --overlay s.vdb --overlay-grid object");
  CHECK(bench.bytes("r.html").find("id=\"gray\"") == std::string::npos);
  CHECK(bench.bytes("o.html").find("id=\"gray\"") != std::string::npos);
}

TEST_CASE("cli: render frames the grains that are selected", "[cli]") {
  const Bench bench;
  bench.write("l.raw", [] {
    std::string voxels(24 * 24 * 24, '\0');
    for (int z = 2; z < 6; ++z)
      for (int y = 4; y < 7; ++y)
        for (int x = 15; x < 20; ++x) voxels[size_t((z * 24 + y) * 24 + x)] = 2;
    voxels[0] = 1;
    return voxels;
  }());
  const std::string raw = " --dims 24x24x24 --type uint8 --no-axes --size 60 ";
  bench.mustRun("render l.raw all.png --only view" + raw);
  bench.mustRun("render l.raw one.png --only view --azimuth 0 --elevation 0 --select 2" + raw);
  // 5 x 4 voxels of 12 pixels, seen along y; a line of the caption below.
  const auto colored = [](const Picture& picture) {
    return std::count_if(picture.pixels.begin(), picture.pixels.end(), [](const Rgb& c) {
      return std::max({c[0], c[1], c[2]}) > std::min({c[0], c[1], c[2]}) + 20;
    });
  };
  CHECK(colored(readPng(bench.bytes("one.png"))) == 60 * 48);
  CHECK(colored(readPng(bench.bytes("all.png"))) < 60 * 48 / 4);
  // The middle slices of all miss it, those of the grain do not.
  bench.mustRun("render l.raw slices.png --only slices --select 2" + raw);
  CHECK(colored(readPng(bench.bytes("slices.png"))) > 100);
  bench.mustRun("render l.raw slices.png --only slices" + raw);
  CHECK(colored(readPng(bench.bytes("slices.png"))) == 0);
}

TEST_CASE("cli: render turns the grains, in pictures of one size", "[cli]") {
  const Bench bench;
  bench.mustRun("generate spheres s.vdb --size 30 --count 4 --radius 4:6");
  const std::string options = " --only view --size 80 --transparent ";
  bench.mustRun("render s.vdb turn.png --turn 3 --azimuth 10" + options);
  const Picture first = readPng(bench.bytes("turn_000.png"));
  for (const char* name : {"turn_001.png", "turn_002.png"}) {
    const Picture next = readPng(bench.bytes(name));
    CHECK(next.width == first.width);
    CHECK(next.height == first.height);
    CHECK(next.pixels != first.pixels);
  }
  CHECK(bench.names().count("turn.png") + bench.names().count("turn_003.png") == 0);
  CHECK(bench.run("render s.vdb w.png --turn 4").exitCode == 2);
  CHECK(bench.run("render s.vdb w.png --only view --turn 1").exitCode == 2);
}

TEST_CASE("cli: render colors grains by a column of their table", "[cli]") {
  const Bench bench;
  bench.mustRun(kSintered + "--voxel-size 10um");
  bench.mustRun("render s.vdb plain.png --size 64");
  bench.mustRun("render s.vdb by.png --size 64 --color-by sphericity");
  CHECK(readPng(bench.bytes("by.png")).pixels != readPng(bench.bytes("plain.png")).pixels);
  bench.write("given.csv", "grain,heat\n1,2\n2,5\n");
  bench.mustRun("render s.vdb given.png --size 64 --color-by heat --with given.csv");
  CHECK(bench.bytes("given.png") != bench.bytes("by.png"));
  bench.write("own.csv", "grain,sphericity,kind\n1,2,a\n9999,5,b\n");
  const auto own = bench.run("render s.vdb own.png --size 64 --color-by sphericity --with own.csv");
  CHECK(own.exitCode == 0);
  CHECK(readPng(bench.bytes("own.png")).pixels != readPng(bench.bytes("by.png")).pixels);
  CHECK_THAT(own.err, vdb_madf::test::Contains("own.csv: left out is what has other cells than "
                                               "numbers, no name of its own, or nothing: 'kind'"));
  CHECK_THAT(own.err, vdb_madf::test::Contains("own.csv: 1 of its 2 grains are not among those"));
  const auto paged = bench.run("report s.vdb own.html --with own.csv");
  CHECK_THAT(paged.err, vdb_madf::test::Contains("own.csv: 1 of its 2 grains are not among those"));
  if (paged.err.find("esbuild") == std::string::npos)  // else there are no pages
    CHECK_THAT(bench.bytes("own.html"), vdb_madf::test::Contains("\"name\":\"given_sphericity\""));
  bench.write("bad.csv", "label,heat\n1,2\n");
  CHECK(
      bench.run("render s.vdb w.png --color-by heat --with bad.csv").err.find("bad.csv: has no") !=
      std::string::npos);
  const auto wrong = bench.run("render s.vdb w.png --color-by hue");
  CHECK(wrong.exitCode == 1);
  CHECK_THAT(wrong.err, vdb_madf::test::Contains("s.vdb: grains have no 'hue': there are id, "));
  CHECK(bench.run("render s.vdb w.png --color-by stability").exitCode == 1);
  bench.mustRun("segment s.vdb k.vdb --keep manifold");
  bench.mustRun("render k.vdb sure.png --size 64 --color-by stability");
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

TEST_CASE("cli: render draws what it is asked for", "[cli]") {
  const Bench bench;
  bench.mustRun(kSintered);
  bench.mustRun("render s.vdb all.png --size 100");
  bench.mustRun("render s.vdb view.png --size 100 --only view");
  bench.mustRun("render s.vdb turned.png --size 100 --only view --azimuth 120 --elevation -10");
  const Picture all = readPng(bench.bytes("all.png")), view = readPng(bench.bytes("view.png"));
  CHECK(all.width > 2 * 100);
  CHECK(view.width <= 100 + 2 * 15);
  CHECK(view.width > 64);
  CHECK(bench.bytes("view.png") != bench.bytes("turned.png"));
  bench.mustRun("render s.vdb again.png --size 100 --threads 1");
  CHECK(bench.bytes("again.png") == bench.bytes("all.png"));
}
