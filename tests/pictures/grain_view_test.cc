// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/pictures/grain_view.h"

#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "support/catch.h"
#include "support/label_shapes.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/grids/grid_metadata.h"

using namespace vdb_madf;
using namespace vdb_madf::test;

namespace {

using Vec = openvdb::Vec3d;

Int32Grid::Ptr ball(const Coord& center, double radius, int32_t label) {
  auto grid = Int32Grid::create(0);
  auto accessor = grid->getAccessor();
  const int reach = int(radius);
  for (auto p = CoordBBox(center - Coord(reach), center + Coord(reach)).begin(); p; ++p)
    if (((*p) - center).asVec3d().length() < radius) accessor.setValue(*p, label);
  return grid;
}

Int32Grid::Ptr randomVoxels(unsigned seed, const CoordBBox& box, unsigned oneIn) {
  std::mt19937 random(seed);
  auto grid = Int32Grid::create(0);
  auto accessor = grid->getAccessor();
  for (auto p = box.begin(); p; ++p)
    if (random() % oneIn == 0) accessor.setValue(*p, int32_t(1 + random() % 50));
  return grid;
}

/// What a pixel shows, by the definition: of all voxels that its ray meets, the one it meets first.
/// `doubtful`: the ray only grazes a voxel before that one, or enters two at once.
struct Seen {
  int32_t label = 0;
  bool doubtful = false;
};

Seen naiveSeen(const Int32Grid& grid, const CoordBBox& box, const Vec& edges, const Vec& origin,
               const Vec& direction) {
  Seen seen;
  double first = std::numeric_limits<double>::infinity();
  for (auto voxel = grid.cbeginValueOn(); voxel; ++voxel) {
    if (*voxel <= 0 || !box.isInside(voxel.getCoord())) continue;
    double in = -1e9, out = 1e9;
    bool grazed = false;  // along a face
    for (int axis = 0; axis < 3; ++axis) {
      const double edge = edges[axis], low = edge * (voxel.getCoord()[axis] - 0.5);
      if (std::abs(direction[axis]) < 1e-12) {
        const double off = std::abs(origin[axis] - low - 0.5 * edge);
        if (off > 0.5 * edge + 1e-9) out = -1e9;
        grazed |= std::abs(off - 0.5 * edge) <= 1e-9;
        continue;
      }
      const double a = (low - origin[axis]) / direction[axis];
      const double b = (low + edge - origin[axis]) / direction[axis];
      in = std::max(in, std::min(a, b));
      out = std::min(out, std::max(a, b));
    }
    if (out < in - 1e-9) continue;
    if (grazed || out < in + 1e-9) {
      if (in < first + 1e-9) seen.doubtful = true;
      continue;
    }
    if (std::abs(in - first) < 1e-9) seen.doubtful = true;
    if (in < first) {
      first = in;
      seen.label = *voxel;
    }
  }
  return seen;
}

/// The view equals the naive one wherever that is sure, and it mostly is.
/// @param edges of a voxel; the shortest is 1
void requireNaiveView(const Int32Grid& grid, const CoordBBox& box, const ViewOptions& options,
                      const Vec& edges = Vec(1)) {
  CAPTURE(options.azimuth, options.elevation);
  const GrainView view = viewGrains(grid, box, grainColors(grid), options);
  const double a = options.azimuth * M_PI / 180, e = options.elevation * M_PI / 180;
  const Vec right(std::cos(a), std::sin(a), 0);
  const Vec up(-std::sin(e) * std::sin(a), std::sin(e) * std::cos(a), std::cos(e));
  const Vec along = up.cross(right);
  const Vec center = 0.5 * edges * (box.min().asVec3d() + box.max().asVec3d());
  const int width = view.picture.width, height = view.picture.height;
  REQUIRE(view.labels.size() == size_t(width) * size_t(height));
  int wrong = 0, doubtful = 0, hits = 0;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const Vec origin = center + (x + 0.5 - width / 2.0) * view.voxelsPerPixel * right +
                         (height / 2.0 - y - 0.5) * view.voxelsPerPixel * up;
      const Seen seen = naiveSeen(grid, box, edges, origin, along);
      doubtful += seen.doubtful;
      hits += seen.label > 0;
      wrong += !seen.doubtful && seen.label != view.labels[size_t(y * width + x)];
    }
  CHECK(hits > width * height / 8);
  CHECK(wrong == 0);
  CHECK(doubtful < width * height / 20);
}

int brightness(const Rgb& color) {
  return color[0] + color[1] + color[2];
}

}  // namespace

TEST_CASE("grain_view: each pixel shows the first voxel on its ray", "[grain_view]") {
  ViewOptions options;
  options.edge = 41;
  unsigned seed = 1;
  for (const auto& [azimuth, elevation] : std::initializer_list<std::pair<double, double>>{
           {35, 25}, {-71.3, 48}, {160, -33}, {255, 12}, {10.7, 89}}) {
    options.azimuth = azimuth;
    options.elevation = elevation;
    const CoordBBox box(Coord(-9, 4, -20), Coord(10, 16, 3));
    requireNaiveView(*randomVoxels(seed++, box, 60), box, options);
  }
}

TEST_CASE("grain_view: unequal voxels are shown in true proportions", "[grain_view]") {
  ViewOptions options;
  options.edge = 41;
  const CoordBBox box(Coord(-9, 4, -20), Coord(10, 16, 3));
  for (const Vec& edges : {Vec(1, 1, 3), Vec(2.5, 1, 1.7)})
    for (const double elevation : {25.0, -50.0, 0.0, 60.0}) {
      const Int32Grid::Ptr grid = randomVoxels(7, box, 60);
      setVoxelSize(*grid, VoxelSize({edges[0] * 1e-6, edges[1] * 1e-6, edges[2] * 1e-6}));
      options.elevation = elevation;
      requireNaiveView(*grid, box, options, edges);
    }
  // A ball that voxels of 1 : 1 : 2 sample is round, and lit as one of cubes.
  auto flat = Int32Grid::create(0);
  for (auto p = CoordBBox(Coord(-21, -21, -11), Coord(21, 21, 11)).begin(); p; ++p)
    if (((*p).asVec3d() * Vec(1, 1, 2)).length() < 20) flat->tree().setValue(*p, 1);
  setVoxelSize(*flat, VoxelSize({1e-6, 1e-6, 2e-6}));
  const Int32Grid::Ptr cubes = ball(Coord(0), 20, 1);
  options.edge = 88;
  options.elevation = 25;
  const GrainView a = viewGrains(*flat, CoordBBox(Coord(-21, -21, -11), Coord(21, 21, 10)),
                                 grainColors(*flat), options),
                  b = viewGrains(*cubes, CoordBBox(Coord(-21, -21, -22), Coord(21, 21, 21)),
                                 grainColors(*cubes), options);
  REQUIRE(a.labels.size() == b.labels.size());
  size_t unlike = 0, hits = 0, otherLight = 0;
  for (size_t i = 0; i < a.labels.size(); ++i) {
    unlike += a.labels[i] != b.labels[i];
    if (!a.labels[i] || !b.labels[i]) continue;
    ++hits;
    otherLight += std::abs(brightness(a.picture.pixels[i]) - brightness(b.picture.pixels[i])) > 90;
  }
  CHECK(hits > 1000);
  CHECK(double(unlike) < 0.06 * double(hits));
  CHECK(double(otherLight) < 0.05 * double(hits));
}

TEST_CASE("grain_view: along the axes, and cut off at the box", "[grain_view]") {
  ViewOptions options;
  options.edge = 47;
  const auto grid = randomVoxels(7, cube(24, Coord(-4)), 20);
  for (const auto& [azimuth, elevation] : std::initializer_list<std::pair<double, double>>{
           {0, 0}, {90, 0}, {180, 0}, {0, 90}, {0, -90}}) {
    options.azimuth = azimuth;
    options.elevation = elevation;
    requireNaiveView(*grid, CoordBBox(Coord(1, 2, 3), Coord(15, 14, 12)), options);
  }
}

TEST_CASE("grain_view: a ball is a disc, lit from above on the left", "[grain_view]") {
  const auto grid = ball(Coord(5, -3, 40), 20, 3);
  ViewOptions options;
  options.edge = 300;
  const GrainColors colors = grainColors(*grid);
  for (const double azimuth : {0.0, 35.0, 77.0}) {
    options.azimuth = azimuth;
    const GrainView view = viewGrains(*grid, cube(60, Coord(-25, -33, 10)), colors, options);
    const auto pixels = double(std::count(view.labels.begin(), view.labels.end(), 3));
    const double area = pixels * view.voxelsPerPixel * view.voxelsPerPixel;
    // Cubes stand out of the ball by up to half of their diagonal.
    CHECK(area > M_PI * 20 * 20);
    CHECK(area < M_PI * 20.9 * 20.9);
    const int x = view.picture.width / 2, y = view.picture.height / 2;
    const int r = int(12 / view.voxelsPerPixel);
    CHECK(brightness(view.picture.at(x - r, y - r)) >
          brightness(view.picture.at(x + r, y + r)) + 60);
    CHECK(view.picture.at(0, 0) == options.background);
  }
}

TEST_CASE("grain_view: what is in front hides what is behind", "[grain_view]") {
  const auto grid = ball(Coord(0, 0, 0), 8, 1);
  grid->tree().merge(ball(Coord(0, 30, 0), 12, 2)->tree());
  const CoordBBox box(Coord(-15, -15, -15), Coord(15, 45, 15));
  const GrainColors colors = grainColors(*grid);
  ViewOptions front;  // looks along +y
  front.azimuth = 0;
  front.elevation = 0;
  const GrainView view = viewGrains(*grid, box, colors, front);
  const size_t middle =
      size_t(view.picture.height / 2) * size_t(view.picture.width) + size_t(view.picture.width / 2);
  CHECK(view.labels[middle] == 1);
  CHECK(std::count(view.labels.begin(), view.labels.end(), 2) > 0);
  ViewOptions back = front;
  back.azimuth = 180;
  const GrainView other = viewGrains(*grid, box, colors, back);
  CHECK(other.labels[middle] == 2);
  CHECK(std::count(other.labels.begin(), other.labels.end(), 1) == 0);
}

TEST_CASE("grain_view: x is to the right and z is up", "[grain_view]") {
  const auto grid = Int32Grid::create(0);
  grid->tree().setValue(Coord(9, 5, 9), 4);
  ViewOptions options;
  options.azimuth = options.elevation = 0;
  options.edge = 10;
  const GrainView view = viewGrains(*grid, cube(10), grainColors(*grid), options);
  REQUIRE(view.picture.width == 10);
  REQUIRE(view.picture.height == 10);
  CHECK(view.labels[9] == 4);
  CHECK(std::count(view.labels.begin(), view.labels.end(), 0) == 99);
}

TEST_CASE("grain_view: tiles and negative labels", "[grain_view]") {
  const auto tiled = Int32Grid::create(0);
  tiled->fill(cube(16), 6);
  REQUIRE(tiled->tree().activeTileCount() > 0);
  const auto voxels = tiled->deepCopy();
  voxels->tree().voxelizeActiveTiles();
  voxels->tree().setValue(Coord(0, -2, 0), -3);  // no label
  const GrainColors colors = grainColors(*tiled);
  const GrainView a = viewGrains(*tiled, cube(20, Coord(-2)), colors);
  const GrainView b = viewGrains(*voxels, cube(20, Coord(-2)), colors);
  CHECK(a.picture.pixels == b.picture.pixels);
  CHECK(a.labels == b.labels);
}

TEST_CASE("grain_view: full leaves at the faces of the box", "[grain_view]") {
  const auto grid = Int32Grid::create(0);
  auto accessor = grid->getAccessor();
  for (auto p = cube(16).begin(); p; ++p)
    accessor.setValue(*p, 1 + ((*p).x() + 2 * (*p).y() + 3 * (*p).z()) % 11);
  ViewOptions options;
  options.edge = 40;
  requireNaiveView(*grid, CoordBBox(Coord(0, 0, -2), Coord(9, 11, 18)), options);
}

TEST_CASE("grain_view: nothing to see, and options out of range", "[grain_view]") {
  const auto empty = Int32Grid::create(0);
  const GrainView none = viewGrains(*empty, CoordBBox(), GrainColors());
  CHECK(none.picture.pixels == std::vector<Rgb>{ViewOptions().background});
  const GrainView air = viewGrains(*empty, cube(5), GrainColors());
  CHECK(std::count(air.labels.begin(), air.labels.end(), 0) == int64_t(air.labels.size()));
  ViewOptions options;
  options.elevation = 91;
  CHECK_THROWS_AS(viewGrains(*empty, cube(5), GrainColors(), options), InvalidInput);
  options.elevation = 0;
  options.edge = 0;
  CHECK_THROWS_AS(viewGrains(*empty, cube(5), GrainColors(), options), InvalidInput);
}

TEST_CASE("grain_view: what ends within a pixel is smooth", "[grain_view]") {
  // A wall in the light, whose upper edge is slanted.
  const auto grid = Int32Grid::create(0);
  for (auto p = CoordBBox(Coord(0), Coord(63, 3, 63)).begin(); p; ++p)
    if (4 * (*p).z() < 80 + (*p).x()) grid->tree().setValue(*p, 1);
  ViewOptions options;
  options.azimuth = options.elevation = 0;
  options.edge = 40;  // 1.6 voxels a pixel
  const GrainView view = viewGrains(*grid, cube(64), grainColors(*grid), options);
  int between = 0, inside = 0;
  const int wall = brightness(view.picture.at(20, 30));
  for (const Rgb& pixel : view.picture.pixels) {
    between += brightness(pixel) > wall + 60 && brightness(pixel) < 3 * 255 - 60;
    inside += brightness(pixel) < wall + 40;
  }
  CHECK(between > 15);
  CHECK(between < 100);
  CHECK(inside > 600);
}

TEST_CASE("grain_view: where voxels are large, smooth surfaces end smoothly", "[grain_view]") {
  constexpr double kRadius = 9.4;
  LabelMap voxels;
  for (int x = -10; x <= 10; ++x)
    for (int y = -10; y <= 10; ++y)
      for (int z = -10; z <= 10; ++z)
        if (x * x + y * y + z * z <= kRadius * kRadius) voxels[{x, y, z}] = x < 0 ? 1 : 2;
  const auto labels = labelGrid(voxels);
  const CoordBBox box(Coord(-12), Coord(12));
  // How far the rim of what is seen lies from a circle, in voxels.
  const auto unevenness = [&](bool surfaces, int edge) {
    ViewOptions options;
    options.edge = edge;
    options.surfaces = surfaces;
    const GrainView view = viewGrains(*labels, box, grainColors(*labels), options);
    const int width = view.picture.width, height = view.picture.height;
    double least = 1e9, most = 0;
    for (int y = 1; y + 1 < height; ++y)
      for (int x = 1; x + 1 < width; ++x) {
        const auto at = [&](int i, int j) {
          return view.labels[size_t(j) * size_t(width) + size_t(i)];
        };
        if (!at(x, y) || (at(x - 1, y) && at(x + 1, y) && at(x, y - 1) && at(x, y + 1))) continue;
        const double away = std::hypot(x + 0.5 - 0.5 * width, y + 0.5 - 0.5 * height);
        least = std::min(least, away);
        most = std::max(most, away);
      }
    CHECK(most * view.voxelsPerPixel == Approx(kRadius).epsilon(0.1));
    return (most - least) * view.voxelsPerPixel;
  };
  CHECK(unevenness(false, 300) > 0.7);
  CHECK(unevenness(true, 300) < 0.5);
  CHECK(unevenness(true, 60) == unevenness(false, 60));  // voxels of two pixels
}

TEST_CASE("grain_view: the box is drawn behind the grains and its axes are named", "[grain_view]") {
  const auto grid = ball(Coord(20, 20, 20), 12, 1);
  ViewOptions options;
  options.edge = 400;
  const GrainColors colors = grainColors(*grid);
  const GrainView plain = viewGrains(*grid, cube(41), colors, options);
  options.box = true;
  const GrainView boxed = viewGrains(*grid, cube(41), colors, options);
  CHECK(std::max(boxed.picture.width, boxed.picture.height) <= 400);
  CHECK(boxed.voxelsPerPixel > plain.voxelsPerPixel);  // the names want room
  int lines = 0, onGrains = 0;
  for (size_t i = 0; i < boxed.labels.size(); ++i) {
    const Rgb& c = boxed.picture.pixels[i];
    const bool ink = c[2] > c[0] + 3 && c[2] < c[0] + 16 && brightness(c) < 700;
    lines += ink && boxed.labels[i] == 0;
    onGrains += ink && boxed.labels[i] == 1;
  }
  CHECK(lines > 1500);
  CHECK(onGrains == 0);
  // Nine edges: the three before the grains are left out, so their corner is empty.
  options.azimuth = options.elevation = 45;
  const auto air = Int32Grid::create(0);
  const GrainView edges = viewGrains(*air, cube(41), GrainColors(), options);
  const int x = edges.picture.width / 2;
  CHECK(edges.picture.at(x, int(edges.picture.height * 0.6)) == options.background);
}

TEST_CASE("grain_view: threads do not matter", "[grain_view]") {
  const auto grid = randomVoxels(9, cube(40), 9);
  const GrainColors colors = grainColors(*grid);
  ViewOptions options;
  options.edge = 120;
  options.box = true;
  const GrainView parallel = viewGrains(*grid, cube(40), colors, options);
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const GrainView sequential = viewGrains(*grid, cube(40), colors, options);
  CHECK(parallel.picture.pixels == sequential.picture.pixels);
  CHECK(parallel.labels == sequential.labels);
}
