// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/grids/resampled_grid.h"

#include <algorithm>
#include <optional>

#include "support/catch.h"
#include "support/random_case.h"
#include "support/runs.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/grids/grid_metadata.h"

using namespace vdb_madf;
using namespace vdb_madf::test;
using openvdb::Vec3d;

namespace {

constexpr double kUnit = 1e-7;  // meters: a tenth of a micrometer

VoxelSize sizeOf(const Coord& edges) {
  return VoxelSize({edges.x() * kUnit, edges.y() * kUnit, edges.z() * kUnit});
}

/// The definition, voxel by voxel, for whole edges.
struct NaiveCubes {
  CoordBBox box;  ///< of the voxels
  Coord voxel;    ///< edges
  int cube;       ///< edge

  CoordBBox cubes() const {
    Coord count;
    for (int axis = 0; axis < 3; ++axis)
      count[axis] = (2 * box.dim()[axis] * voxel[axis] + cube) / (2 * cube);
    return {Coord(0), count.offsetBy(-1)};
  }
  bool isNothing() const {
    const Coord count = cubes().dim();
    return std::min({count.x(), count.y(), count.z()}) == 0;
  }
  /// The length that a voxel and a cube have in common along an axis.
  int64_t common(const Coord& p, const Coord& place, int axis) const {
    const int v = p[axis] - box.min()[axis], c = place[axis];
    return std::max(
        0, std::min((v + 1) * voxel[axis], (c + 1) * cube) - std::max(v * voxel[axis], c * cube));
  }
  /// At least half of the cube's volume is object.
  ObjectVolume byVolume(const ObjectVolume& object) const {
    ObjectVolume result(cubes());
    for (int n = 0; n < result.size(); ++n) {
      const Coord place = result.coord(n);
      CoordBBox around;  // voxels that the cube meets, and some more
      for (int axis = 0; axis < 3; ++axis) {
        around.min()[axis] = box.min()[axis] + place[axis] * cube / voxel[axis];
        around.max()[axis] = box.min()[axis] + (place[axis] + 1) * cube / voxel[axis];
      }
      int64_t volume = 0;
      for (auto p = around.begin(); p; ++p)
        if (object.get(*p, 0))
          volume += common(*p, place, 0) * common(*p, place, 1) * common(*p, place, 2);
      result[n] = 2 * volume >= int64_t(cube) * cube * cube;
    }
    return result;
  }
  /// The voxel whose center is nearest to that of a cube, the lower one along each axis.
  Coord nearest(const Coord& place) const {
    Coord result;
    for (int axis = 0; axis < 3; ++axis) {
      const auto apart = [&](int v) {
        return std::abs((2 * v + 1) * voxel[axis] - (2 * place[axis] + 1) * cube);
      };
      int best = 0;
      for (int v = 1; v < box.dim()[axis]; ++v)
        if (apart(v) < apart(best)) best = v;
      result[axis] = best;
    }
    return box.min() + result;
  }
};

Coord randomEdges(Rng& rng) {
  return {rng.between(3, 12), rng.between(3, 12), rng.between(3, 12)};
}

/// A case with a domain, that is a region every other time, and its voxels in cubes.
struct Resampling {
  RandomCase c;
  NaiveCubes naive;
  MaskGrid::Ptr mask;

  explicit Resampling(uint64_t seed) {
    Rng rng(seed);
    const Coord size(rng.between(1, 12), rng.between(1, 12), rng.between(1, 12));
    c = randomCase(seed, seed % 5 == 0 ? Coord(17, 16, 18) : size);  // these hold tiles
    if (seed % 3 == 0) drawRegion(c);
    mask = toMask(c.object, c.tiles);
    if (c.domain) setDomain(*mask, *domainOf(c));
    const CoordBBox known = c.domain ? domainOf(c)->box() : objectBox(c.object);
    naive = {known, randomEdges(rng), rng.between(3, 16)};
    setVoxelSize(*mask, sizeOf(naive.voxel));
    mask->setName("object");
  }
  bool isNothing() const {
    if (naive.box.empty() || naive.isNothing()) return true;
    return isRegion() && countObject(naive.byVolume(*c.region)) == 0;
  }
  /// A region that fills its box is a box.
  bool isRegion() const { return c.domain && !domainOf(c)->isBox(); }
  double edge() const { return naive.cube * kUnit; }
};

}  // namespace

TEST_CASE("resampled_grid: a cube is object if half of its volume is", "[resampled_grid]") {
  int resampled = 0, regions = 0, tiles = 0, unknown = 0, ties = 0;
  for (uint64_t seed = 1; seed <= 360; ++seed) {
    const Resampling r(seed);
    if (r.naive.box.empty()) continue;
    INFO(describe(r.c) << "edges " << r.naive.voxel << " cube " << r.naive.cube);
    if (r.isNothing()) {
      CHECK_THROWS_AS(resampleMask(*r.mask, r.edge()), InvalidInput);
      continue;
    }
    const MaskGrid::Ptr cubes =
        withThreads(int(seed % 2) + 1, [&] { return resampleMask(*r.mask, r.edge()); });
    const ObjectVolume expected = r.naive.byVolume(r.c.object);
    REQUIRE(withBox(toObject(*cubes), r.naive.cubes()) == expected);
    REQUIRE(int64_t(cubes->activeVoxelCount()) == countObject(expected));
    const auto domain = storedDomain(*cubes);
    REQUIRE(domain.has_value() == r.c.domain.has_value());
    if (r.isRegion())
      REQUIRE(*domain == Domain(toMask(r.naive.byVolume(*r.c.region))->tree()));
    else if (domain)
      REQUIRE(*domain == Domain(r.naive.cubes()));
    ++resampled;
    regions += domain && !domain->isBox();
    tiles += r.mask->tree().activeTileCount() > 0;
    unknown += !domain;
    ties += r.naive.cube % 2 == 0;
  }
  CHECK(resampled > 250);
  CHECK(regions > 50);
  CHECK(tiles > 5);
  CHECK(unknown > 20);
  CHECK(ties > 50);
}

TEST_CASE("resampled_grid: a cube has the label of the nearest voxel", "[resampled_grid]") {
  int labelled = 0, cut = 0;
  for (uint64_t seed = 1; seed <= 360; ++seed) {
    const Resampling r(seed);
    if (r.isNothing()) continue;
    INFO(describe(r.c) << "edges " << r.naive.voxel << " cube " << r.naive.cube);
    const auto labels = Int32Grid::create(0);
    labels->insertMeta(*r.mask);
    labels->setTransform(r.mask->transform().copy());
    labels->topologyUnion(*r.mask);
    Rng rng(seed);
    if (r.c.tiles == Tiles::wherePossible)
      for (auto value = labels->beginValueOn(); value; ++value) value.setValue(rng.between(1, 9));
    else
      for (auto value = labels->beginValueOn(); value; ++value)
        value.setValue(rng.between(-1, 4));  // what is not positive is background
    const Int32Grid::Ptr cubes =
        withThreads(int(seed % 2) + 1, [&] { return resampleLabels(*labels, r.edge()); });
    const auto domain = storedDomain(*cubes);
    const CoordBBox box = r.naive.cubes();
    int64_t expected = 0, wrong = 0;
    for (auto p = box.begin(); p; ++p) {
      const Coord voxel = r.naive.nearest(*p);
      const int32_t value = labels->tree().isValueOn(voxel) ? labels->tree().getValue(voxel) : 0;
      const bool inside = !domain || domain->isInside(*p);
      const int32_t label = value > 0 && inside ? value : 0;
      wrong += cubes->tree().getValue(*p) != label || cubes->tree().isValueOn(*p) != (label > 0);
      expected += label > 0;
      cut += value > 0 && !inside;
    }
    REQUIRE(wrong == 0);
    REQUIRE(int64_t(cubes->activeVoxelCount()) == expected);
    REQUIRE(domain == storedDomain(*resampleMask(*r.mask, r.edge())));
    labelled += expected > 0;
  }
  CHECK(labelled > 150);
  CHECK(cut > 20);
}

TEST_CASE("resampled_grid: large tiles stay tiles", "[resampled_grid]") {
  const auto mask = MaskGrid::create(false);
  const CoordBBox box(Coord(-128), Coord(127));
  mask->sparseFill(box, true);
  setDomain(*mask, box);
  setVoxelSize(*mask, VoxelSize({1e-6, 2e-6, 3e-6}));
  const auto cubes = resampleMask(*mask, 1e-6);
  CHECK(cubes->activeVoxelCount() == uint64_t(256) * 512 * 768);
  CHECK(cubes->tree().leafCount() == 0);
  // A tile of a region, too; its faces lie within leaf nodes.
  MaskTree region(false);
  region.addTile(2, Coord(0), true, true);
  region.setValueOn(Coord(-128));
  setDomain(*mask, Domain(region));
  mask->tree().clear();
  const auto inside = storedDomain(*resampleMask(*mask, 7e-6));
  REQUIRE(inside);
  CHECK(inside->box() == CoordBBox(Coord(18, 37, 55), Coord(36, 72, 109)));
  CHECK(double(inside->voxelCount()) == Approx(128. * 256 * 384 / (7 * 7 * 7)).epsilon(0.05));
}

TEST_CASE("resampled_grid: cubes of the same size, and of half of it, are the same object",
          "[resampled_grid]") {
  for (uint64_t seed = 1; seed <= 40; ++seed) {
    RandomCase c = randomCase(seed, Coord(9, 10, 11));
    const auto mask = maskOf(c);
    setDomain(*mask, c.object.box());
    setVoxelSize(*mask, VoxelSize(1.3e-6));
    const Coord low = c.object.box().min();
    const auto same = resampleMask(*mask, 1.3e-6), halves = resampleMask(*mask, 0.65e-6);
    REQUIRE(translated(withBox(toObject(*same), {Coord(0), Coord(8, 9, 10)}), low) == c.object);
    REQUIRE(halves->activeVoxelCount() == 8 * mask->activeVoxelCount());
    bool inside = true;
    for (auto p = halves->cbeginValueOn(); p; ++p) {
      const Coord at = p.getCoord();
      inside = inside && c.object[low + Coord(at.x() / 2, at.y() / 2, at.z() / 2)];
    }
    REQUIRE(inside);
  }
}

TEST_CASE("resampled_grid: the corner of the box stays in the world", "[resampled_grid]") {
  const auto mask = MaskGrid::create(false);
  mask->setName("ice");
  const CoordBBox box(Coord(4, -3, 10), Coord(13, 6, 19));
  mask->denseFill(box, true);
  setDomain(*mask, box);
  mask->insertMeta(kSourceKey, openvdb::StringMetadata("a.tif"));
  const auto corners = [](const openvdb::GridBase& grid) {
    const CoordBBox domain = storedDomain(grid)->box();
    return std::pair(grid.indexToWorld(domain.min().asVec3d() - Vec3d(0.5)),
                     grid.indexToWorld(domain.max().asVec3d() + Vec3d(0.5)));
  };
  const double millimetres = 1e3;  // in a meter
  for (const bool mirrored : {false, true}) {
    setVoxelSize(*mask, VoxelSize({0.5e-6, 0.6e-6, 1.2e-6}));
    if (mirrored) mask->transform().preScale(Vec3d(1, 1, -1));
    mask->transform().postTranslate(Vec3d(7, 8, 9));
    const auto [low, high] = corners(*mask);
    for (const double edge : {0.1e-6, 0.3e-6, 1e-6, 0.015e-6, 3e-6}) {
      CAPTURE(edge, mirrored);
      const auto cubes = resampleMask(*mask, edge);
      CHECK(cubes->getName() == "ice");
      CHECK(cubes->getMetadata<openvdb::StringMetadata>(kSourceKey)->value() == "a.tif");
      CHECK(storedVoxelSize(*cubes)->edges() == VoxelSize(edge).edges());
      CHECK(hasCubicVoxels(*cubes));
      const auto [first, last] = corners(*cubes);
      const double unit = edge < 20e-9 ? 1e3 : 1;  // micrometers
      CHECK((first - low * unit).length() < 1e-9 * unit);
      for (int axis = 0; axis < 3; ++axis)
        CHECK(std::abs(last[axis] - high[axis] * unit) < 0.501 * edge * millimetres * unit);
    }
  }
}

TEST_CASE("resampled_grid: what makes no sense is refused", "[resampled_grid]") {
  const auto mask = MaskGrid::create(false);
  mask->denseFill({Coord(0), Coord(99)}, true);
  CHECK_THROWS_WITH(resampleMask(*mask, 1e-6),
                    vdb_madf::test::Contains("size of its voxels is unknown"));
  setVoxelSize(*mask, VoxelSize({1e-6, 1e-6, 2e-6}));
  CHECK_THROWS_WITH(resampleMask(*mask, 300e-6), vdb_madf::test::Contains("256 times"));
  CHECK_THROWS_WITH(resampleMask(*mask, 7e-9), vdb_madf::test::Contains("256 times"));
  CHECK_THROWS_WITH(resampleMask(*mask, 0), vdb_madf::test::Contains("256 times"));
  CHECK_THROWS_WITH(resampleMask(*mask, 201e-6), vdb_madf::test::Contains("half as thick"));
  CHECK_THROWS_WITH(resampleMask(*mask, 0.01e-6), vdb_madf::test::Contains("4294966784 voxels"));
  setDomain(*mask, CoordBBox(Coord(0), Coord(98, 99, 99)));
  CHECK_THROWS_WITH(resampleMask(*mask, 1e-6), vdb_madf::test::Contains("leaves its domain"));
  setDomain(*mask, CoordBBox(Coord(0), Coord(20000, 99, 99)));
  CHECK(resampleMask(*mask, 1e-6)->activeVoxelCount() == 2000000);
  CHECK_THROWS_WITH(resampleMask(*mask, 0.5e-6), vdb_madf::test::Contains("26754 voxels long"));
  StopAtOnce stop;
  CHECK_THROWS_AS(resampleMask(*mask, 1e-6, &stop), Interrupted);
  const auto empty = Int32Grid::create(0);
  setVoxelSize(*empty, VoxelSize(1e-6));
  setDomain(*empty, CoordBBox(Coord(0), Coord(9)));
  CHECK(resampleLabels(*empty, 2e-6)->empty());
}
