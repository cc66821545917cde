// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/labels/grain_colors.h"

#include <tbb/global_control.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <random>
#include <set>

#include "support/catch.h"
#include "support/label_shapes.h"
#include "vdb_madf/base/errors.h"

using namespace vdb_madf;
using namespace vdb_madf::test;

namespace {

using Pairs = std::set<std::pair<int32_t, int32_t>>;

Int32Grid::Ptr randomBlocks(unsigned seed, const CoordBBox& box, int count, int blockEdge) {
  std::mt19937 random(seed);
  auto grid = Int32Grid::create(0);
  auto accessor = grid->getAccessor();
  for (int x = box.min().x(); x <= box.max().x(); x += blockEdge)
    for (int y = box.min().y(); y <= box.max().y(); y += blockEdge)
      for (int z = box.min().z(); z <= box.max().z(); z += blockEdge) {
        const auto label = int32_t(random() % unsigned(count + 1));
        if (!label) continue;
        for (int i = 0; i < blockEdge * blockEdge * blockEdge; ++i)
          accessor.setValue(Coord(x + i / blockEdge / blockEdge, y + i / blockEdge % blockEdge,
                                  z + i % blockEdge),
                            label * 7);
      }
  return grid;
}

/// Cells of the nearest of random points: packed grains.
Int32Grid::Ptr packedCells(unsigned seed, const CoordBBox& box, int count) {
  std::mt19937 random(seed);
  std::vector<Coord> points;
  for (int i = 0; i < count; ++i) {
    Coord point;
    for (int axis = 0; axis < 3; ++axis)
      point[axis] = box.min()[axis] + int(random() % unsigned(box.extents()[axis]));
    points.push_back(point);
  }
  auto grid = Int32Grid::create(0);
  for (auto p = box.begin(); p; ++p) {
    const auto distance = [&](const Coord& q) { return ((*p) - q).asVec3d().lengthSqr(); };
    const auto nearest =
        std::min_element(points.begin(), points.end(),
                         [&](const Coord& a, const Coord& b) { return distance(a) < distance(b); });
    grid->tree().setValue(*p, int32_t(1 + (nearest - points.begin())));
  }
  return grid;
}

/// Labels at 26-adjacent voxels, by walking all voxels of the box.
Pairs naiveContacts(const Int32Grid& grid, const CoordBBox& box) {
  const auto accessor = grid.getConstAccessor();
  const auto at = [&](const Coord& p) {
    return accessor.isValueOn(p) ? std::max(0, accessor.getValue(p)) : 0;
  };
  Pairs pairs;
  for (auto p = box.begin(); p; ++p) {
    const int32_t a = at(*p);
    if (!a) continue;
    for (auto d = CoordBBox(Coord(-1), Coord(1)).begin(); d; ++d) {
      const int32_t b = at(*p + *d);
      if (b > a) pairs.emplace(a, b);
    }
  }
  return pairs;
}

using Vector = std::array<double, 3>;
using Matrix = std::array<Vector, 3>;

Vector product(const Matrix& m, const Vector& v) {
  Vector result;
  for (size_t i = 0; i < 3; ++i) result[i] = m[i][0] * v[0] + m[i][1] * v[1] + m[i][2] * v[2];
  return result;
}

/// What eyes see of linear sRGB: normal ones, then those without one kind of cones, simulated after
/// Machado, Oliveira & Fernandes 2009.
const Matrix kEyes[] = {
    {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}},
    {{{0.152286, 1.052583, -0.204868},
      {0.114503, 0.786281, 0.099216},
      {-0.003882, -0.048116, 1.051998}}},  // protanopia
    {{{0.367322, 0.860646, -0.227968},
      {0.280085, 0.672501, 0.047413},
      {-0.011820, 0.042940, 0.968881}}},  // deuteranopia
    {{{1.255528, -0.076749, -0.178779},
      {-0.078411, 0.930809, 0.147602},
      {0.004733, 0.691367, 0.303900}}},  // tritanopia
};

/// CIELAB of sRGB under D65 (IEC 61966-2-1; CIE 15), as the eyes see it.
Vector lab(const Rgb& color, const Matrix& eyes) {
  Vector c;
  for (size_t i = 0; i < 3; ++i) {
    const double v = color[i] / 255.0;
    c[i] = v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4);
  }
  c = product(eyes, c);
  for (double& channel : c) channel = std::clamp(channel, 0.0, 1.0);
  const Vector xyz = product({{{0.4124564 / 0.95047, 0.3575761 / 0.95047, 0.1804375 / 0.95047},
                               {0.2126729, 0.7151522, 0.0721750},
                               {0.0193339 / 1.08883, 0.1191920 / 1.08883, 0.9503041 / 1.08883}}},
                             c);
  Vector f;
  for (size_t i = 0; i < 3; ++i)
    f[i] = xyz[i] > 216.0 / 24389 ? std::cbrt(xyz[i]) : (24389.0 / 27 * xyz[i] + 16) / 116;
  return {116 * f[1] - 16, 500 * (f[0] - f[1]), 200 * (f[1] - f[2])};
}

double difference(const Rgb& a, const Rgb& b, const Matrix& eyes) {
  const auto p = lab(a, eyes), q = lab(b, eyes);
  return std::hypot(p[0] - q[0], p[1] - q[1], p[2] - q[2]);
}

struct Differences {
  double normal = 1e9, colorBlind = 1e9;
};

/// The least differences of touching labels, to normal eyes and to others; the colors must be there
/// for all labels of the grid.
Differences leastDifferences(const Int32Grid& grid, const GrainColors& colors,
                             const Pairs& contacts) {
  std::set<int32_t> labels;
  for (auto voxel = grid.cbeginValueOn(); voxel; ++voxel)
    if (*voxel > 0) labels.insert(*voxel);
  CHECK(std::set<int32_t>(colors.labels.begin(), colors.labels.end()) == labels);
  CHECK(colors.labels.size() == colors.colors.size());
  CHECK(colors.touchingPairs == int64_t(contacts.size()));
  Differences least;
  for (const auto& [a, b] : contacts)
    for (const Matrix& eyes : kEyes) {
      double& of = &eyes == kEyes ? least.normal : least.colorBlind;
      of = std::min(of, difference(colors.colorOf(a), colors.colorOf(b), eyes));
    }
  return least;
}

}  // namespace

TEST_CASE("grain_colors: touching grains are apart for all eyes", "[grain_colors]") {
  for (unsigned seed = 1; seed <= 6; ++seed) {
    CAPTURE(seed);
    const CoordBBox box = cube(24, Coord(-11, 3, -5));
    const auto grid = packedCells(seed, box, 80);
    const Pairs contacts = naiveContacts(*grid, cube(30, Coord(-13, 1, -7)));
    REQUIRE(contacts.size() > 100);
    const GrainColors colors = grainColors(*grid);
    CHECK(colors.alikePairs == 0);
    const Differences least = leastDifferences(*grid, colors, contacts);
    CHECK(least.normal >= 26);
    CHECK(least.colorBlind >= 15);
  }
}

TEST_CASE("grain_colors: many labels that all touch get the wider palette", "[grain_colors]") {
  // Single voxels at random: each of 50 labels meets each other.
  const auto grid = randomBlocks(3, cube(32), 50, 1);
  const Pairs contacts = naiveContacts(*grid, cube(32));
  REQUIRE(contacts.size() == 50 * 49 / 2);
  const GrainColors colors = grainColors(*grid);
  CHECK(colors.alikePairs == 0);
  const Differences least = leastDifferences(*grid, colors, contacts);
  CHECK(least.normal >= 12);
  CHECK(least.colorBlind >= 5);
}

TEST_CASE("grain_colors: noise beyond the palette is counted", "[grain_colors]") {
  const auto grid = randomBlocks(4, cube(40), 80, 1);
  const Pairs contacts = naiveContacts(*grid, cube(40));
  const GrainColors colors = grainColors(*grid);
  int64_t alike = 0;
  for (const auto& [a, b] : contacts) alike += colors.colorOf(a) == colors.colorOf(b);
  CHECK(alike >= 80 - 64);
  CHECK(colors.alikePairs == alike);
}

TEST_CASE("grain_colors: corners touch, across leaves and tiles too", "[grain_colors]") {
  for (const Coord& step : {Coord(1, 0, 0), Coord(1, -1, 0), Coord(-1, 1, 1)}) {
    for (int at = 0; at <= 8; ++at) {
      const auto grid = Int32Grid::create(0);
      grid->tree().setValue(Coord(at), 5);
      grid->tree().setValue(Coord(at) + step, 9);
      CHECK(grainColors(*grid).touchingPairs == 1);
    }
  }
  const auto tiled = Int32Grid::create(0);
  tiled->fill(CoordBBox(Coord(0), Coord(7)), 1);
  tiled->fill(CoordBBox(Coord(8), Coord(15)), 2);
  REQUIRE(tiled->tree().activeTileCount() == 2);
  tiled->tree().setValue(Coord(16, 15, 15), 3);
  const GrainColors colors = grainColors(*tiled);
  CHECK(colors.labels == std::vector<int32_t>{1, 2, 3});
  CHECK(colors.touchingPairs == 2);
}

TEST_CASE("grain_colors: distance and what is no label do not touch", "[grain_colors]") {
  const auto grid = Int32Grid::create(0);
  grid->tree().setValue(Coord(0), 1);
  grid->tree().setValue(Coord(2, 0, 0), 2);
  grid->tree().setValue(Coord(1, 0, 0), -4);
  grid->tree().setValueOff(Coord(1, 1, 0), 7);
  const GrainColors colors = grainColors(*grid);
  CHECK(colors.labels == std::vector<int32_t>{1, 2});
  CHECK(colors.touchingPairs == 0);
  CHECK(colors.colorOf(7) == Rgb{128, 128, 128});
  CHECK(grainColors(*Int32Grid::create(0)).labels.empty());
}

TEST_CASE("grain_colors: neighboring numbers spread over the palette", "[grain_colors]") {
  const auto grid = Int32Grid::create(0);
  for (int i = 0; i < 240; ++i) grid->tree().setValue(Coord(3 * i, 0, 0), i + 1);
  std::map<Rgb, int> uses;
  const GrainColors colors = grainColors(*grid);
  for (const Rgb& color : colors.colors) ++uses[color];
  CHECK(uses.size() == 16);
  for (const auto& [color, count] : uses) CHECK(count <= 30);
}

TEST_CASE("grain_colors: threads do not matter", "[grain_colors]") {
  const auto grid = randomBlocks(5, cube(64), 400, 4);
  const GrainColors parallel = grainColors(*grid);
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const GrainColors sequential = grainColors(*grid);
  CHECK(parallel.labels == sequential.labels);
  CHECK(parallel.colors == sequential.colors);
  CHECK(parallel.touchingPairs == sequential.touchingPairs);
}
