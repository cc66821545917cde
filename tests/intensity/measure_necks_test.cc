// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/intensity/measure_necks.h"

#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <limits>

#include "support/catch.h"
#include "support/known_bodies.h"
#include "support/memory_image.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/grids/grid_metadata.h"
#include "vdb_madf/intensity/estimate_blur.h"
#include "vdb_madf/measure/columns.h"
#include "vdb_madf/scans/filtered_image.h"
#include "vdb_madf/segmentation/segment.h"

using namespace vdb_madf;
using namespace vdb_madf::test;

namespace {

constexpr int kCell = 56;

/// Two balls around a center, along a direction: with a sharp neck, or one that a torus rounds, or
/// with a gap between them.
struct Pair {
  Vec3d center, normal;
  double first = 10, second = 12;  // radii of the balls
  double neck = 5, fillet = 0;     // radii; of a gap the first is minus half its width

  bool holds(const Vec3d& p) const {
    const Vec3d q = p - center;
    const double z = q.dot(normal), square = q.lengthSqr() - z * z;
    const double ring = neck + fillet;
    const auto offset = [&](double ball) {
      return neck < 0 ? ball - neck : std::sqrt(std::pow(ball + fillet, 2) - ring * ring);
    };
    const double a = offset(first), b = offset(second);
    if (square + (z + a) * (z + a) < first * first || square + (z - b) * (z - b) < second * second)
      return true;
    return fillet > 0 && z > -a * fillet / (first + fillet) && z < b * fillet / (second + fillet) &&
           square < ring * ring && std::pow(std::sqrt(square) - ring, 2) + z * z > fillet * fillet;
  }
};

/// The part of a voxel that a pair fills.
double share(const Pair& pair, const Vec3d& p) {
  const auto shareOf = [&](int parts, double edge) {
    int count = 0;
    for (int i = 0; i < parts * parts * parts; ++i) {
      const Vec3d part(i % parts, i / parts % parts, i / parts / parts);
      count += pair.holds(p + ((part + Vec3d(0.5)) / parts - Vec3d(0.5)) * edge);
    }
    return double(count) / (parts * parts * parts);
  };
  const double corners = shareOf(2, 2);
  return corners == 0 || corners == 1 ? corners : shareOf(4, 1);
}

/// A row of pairs along x, a cell each, as a scanner shows it: 1000 is pore, 3000 solid.
struct Row {
  std::vector<Pair> pairs;
  ImageSize size;
  std::vector<float> grays;

  Row(std::vector<Pair> list, double blur, double noise)
      : pairs(std::move(list)), size{int(pairs.size()) * kCell, kCell, kCell} {
    for (int z = 0; z < size.z; ++z)
      for (int y = 0; y < size.y; ++y)
        for (int x = 0; x < size.x; ++x)
          grays.push_back(1000 + 2000 * float(share(pairs[size_t(x / kCell)], Vec3d(x, y, z))));
    smoothedImage(imageOf(size, grays), blur)->read(0, size.z, grays.data());
    Rng rng(pairs.size());
    for (float& gray : grays) {
      double normal = -6;  // of the sum of twelve
      for (int i = 0; i < 12; ++i) normal += rng.unit();
      gray += float(2000 * noise * normal);
    }
  }
  CoordBBox box() const { return {Coord(0), Coord(size.x - 1, size.y - 1, size.z - 1)}; }
  GrayScan scan() const { return {imageOf(size, grays), Coord(0)}; }
  /// By the gray value in the middle, and at most as far from a pair's center as its balls go.
  bool isSolid(const Vec3d& p) const {
    const size_t at = (size_t(p.z()) * size_t(size.y) + size_t(p.y())) * size_t(size.x);
    return grays[at + size_t(p.x())] >= 2000 &&
           (p - pairs[size_t(p.x()) / kCell].center).length() < 0.5 * kCell;
  }
  /// The sides of pair i: 2 i + 1 and 2 i + 2.
  Int32Grid::Ptr sides() const {
    const auto labels = drawLabels(box(), [&](const Vec3d& p) {
      const size_t i = size_t(p.x()) / kCell;
      const bool second = (p - pairs[i].center).dot(pairs[i].normal) > 0;
      return isSolid(p) ? int(2 * i) + (second ? 2 : 1) : 0;
    });
    setDomain(*labels, box());
    return labels;
  }
};

const Row& fourPairs() {
  static const Row row({{{28.2, 27.9, 28.4}, Vec3d(0.6, -0.64, 0.48), 10, 12, 5, 0},
                        {{84.3, 28.1, 27.7}, Vec3d(-0.48, 0.6, 0.64), 11, 9, 7, 0},
                        {{139.8, 28.3, 28.1}, Vec3d(0, 0.8, -0.6), 10, 11, 5, 2.5},
                        {{196.1, 27.6, 28.2}, Vec3d(0.64, 0.48, 0.6), 10, 9, -0.4, 0}},
                       0.8, 0.04);
  return row;
}

/// Neck radii from 4 voxels on; a quarter each has a fillet of 1 to 4 voxels, a gap of 0.7 to 2.
std::vector<Pair> randomPairs(size_t count, uint64_t seed) {
  Rng rng(seed);
  std::vector<Pair> pairs;
  for (size_t i = 0; i < count; ++i) {
    Pair pair;
    pair.center = Vec3d(kCell * (double(i) + 0.5), kCell / 2, kCell / 2) + randomPoint(rng);
    pair.normal = randomDirection(rng);
    pair.first = 8 + 4 * rng.unit();
    pair.second = 8 + 4 * rng.unit();
    pair.neck = 4 + rng.unit() * (0.7 * std::min(pair.first, pair.second) - 4);
    if (i % 4 == 2) pair.fillet = 1 + 3 * rng.unit();
    if (i % 4 == 3) pair.neck = -(0.35 + 0.65 * rng.unit());
    pairs.push_back(pair);
  }
  return pairs;
}

/// Relative errors.
struct Spread {
  double sum = 0, squares = 0;
  int count = 0;
  void add(double error) {
    sum += error;
    squares += error * error;
    ++count;
  }
  double mean() const { return sum / count; }
  double deviation() const { return std::sqrt(squares / count - mean() * mean()); }
};

}  // namespace

TEST_CASE("estimate_blur: a Gaussian and the voxel, whatever the noise", "[measure_necks]") {
  const auto blur = estimateBlur(*fourPairs().scan().image);
  REQUIRE(blur);
  CHECK(blur->sigma == Approx(std::sqrt(0.8 * 0.8 + 1.0 / 12)).epsilon(0.02));
  CHECK(blur->noise == Approx(0.04).epsilon(0.02));
  CHECK(blur->inside == Approx(3000).epsilon(0.002));
  CHECK(blur->outside == Approx(1000).epsilon(0.002));
}

TEST_CASE("estimate_blur: what one value at all corners surrounds", "[measure_necks]") {
  Row row = fourPairs();
  std::vector<float>& round = row.grays;
  size_t at = 0;
  for (int z = 0; z < row.size.z; ++z)
    for (int y = 0; y < row.size.y; ++y)
      for (int x = 0; x < row.size.x; ++x, ++at)
        if (std::hypot((x - 111.5) / 4, y - 27.5) > 27) round[at] = 0;
  const auto blur = estimateBlur(*row.scan().image);
  REQUIRE(blur);
  CHECK(blur->sigma == Approx(0.85).epsilon(0.03));
  CHECK(blur->outside == Approx(1000).epsilon(0.002));
}

TEST_CASE("estimate_blur: none of a mask, noise, one value, NaN or small grains",
          "[measure_necks]") {
  Row row = fourPairs();
  std::vector<float>& values = row.grays;
  std::fill(values.begin(), values.end(), 7.0F);
  CHECK_FALSE(estimateBlur(*row.scan().image));
  Rng rng(3);
  for (float& value : values) value = float(rng.unit());
  CHECK_FALSE(estimateBlur(*row.scan().image));
  for (float& value : values) value = std::numeric_limits<float>::quiet_NaN();
  CHECK_FALSE(estimateBlur(*row.scan().image));
  size_t at = 0;
  for (float& value : values) value = at++ % 12 < 6 ? 1 : 0;  // sheets of six voxels
  CHECK_FALSE(estimateBlur(*row.scan().image));
  row = fourPairs();  // edges that are wider than what is looked at
  smoothedImage(imageOf(row.size, row.grays), 4)->read(0, row.size.z, row.grays.data());
  CHECK_FALSE(estimateBlur(*row.scan().image));
  CHECK_THROWS_AS(blurOf(row.scan(), {}), InvalidInput);
}

TEST_CASE("measure_necks: areas without the blur, gaps, normals", "[measure_necks]") {
  const auto labels = fourPairs().sides();
  Measurements measured = measure(*labels);
  REQUIRE(measured.bonds.size() == 4);
  GrayScan scan = fourPairs().scan();
  const ScanBlur blur = blurOf(fourPairs().scan(), {});
  measureNecks(*labels, scan, blur, measured);
  CHECK(measured.extra.necks);
  CHECK(measured.scan->sigma == blur.sigma);
  for (size_t i = 0; i < 4; ++i) {
    const Neck& neck = measured.bonds[i].neck.value();
    const Pair& pair = fourPairs().pairs[i];
    INFO("pair " << i << ": " << neck.area << " +- " << neck.error);
    CHECK(neck.normal.dot(pair.normal) > std::cos((pair.neck > 0 ? 2 : 5) * M_PI / 180));
    CHECK(neck.radius == Approx(std::sqrt(neck.area / M_PI)));
    CHECK(neck.confirmed == (pair.neck > 0));
    CHECK(neck.gap == Approx(pair.neck > 0 ? 0 : -2 * pair.neck).margin(0.1));
    CHECK(neck.touches() == (pair.neck > 0));
    if (pair.neck < 0) continue;
    const double truth = M_PI * pair.neck * pair.neck;
    CHECK(neck.area == Approx(truth).epsilon(0.06));
    CHECK(std::abs(neck.area - truth) < 3 * neck.error);
    // What the labels say is what blur makes of sharp grooves; a rounded one it hardly changes.
    if (pair.fillet == 0) CHECK(measured.bonds[i].area > 1.1 * truth);
  }
  const auto columns = bondColumns(measured.bonds, measured.extra);
  CHECK(columns[columns.size() - 8].name == "neck_area");
  CHECK(columns[columns.size() - 4].values == std::vector<double>{1, 1, 1, 0});

  SECTION("the same bits on one thread") {
    const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
    Measurements again = measured;
    GrayScan same = fourPairs().scan();
    measureNecks(*labels, same, blur, again);
    for (size_t i = 0; i < 4; ++i) {
      CHECK(again.bonds[i].neck->area == measured.bonds[i].neck->area);
      CHECK(again.bonds[i].neck->error == measured.bonds[i].neck->error);
    }
  }
  SECTION("a brighter end of the scan changes nothing, as each bond has its own contrast") {
    Row row = fourPairs();
    std::vector<float>& tilted = row.grays;
    for (size_t i = 0; i < tilted.size(); ++i)
      tilted[i] += 600 * float(i % size_t(row.size.x)) / float(row.size.x);
    GrayScan other = row.scan();
    Measurements again = measured;
    measureNecks(*labels, other, blur, again);
    for (size_t i = 0; i < 3; ++i)
      CHECK(again.bonds[i].neck->area == Approx(measured.bonds[i].neck->area).epsilon(0.03));
  }
}

TEST_CASE("measure_necks: how wide gaps are", "[measure_necks]") {
  std::vector<Pair> pairs;
  Rng rng(5);
  for (const double gap : {0.0, 0.0, 0.2, 0.2, 0.5, 0.5, 0.8, 0.8}) {
    const Vec3d center = Vec3d(kCell * (double(pairs.size()) + 0.5), 28, 28) + randomPoint(rng);
    pairs.push_back({center, randomDirection(rng), 8, 8 + 0.5 * double(pairs.size()), -gap / 2});
  }
  for (const double noise : {0.01, 0.05, 0.1}) {
    const Row row(pairs, 0.7, noise);
    const auto labels = row.sides();
    Measurements measured = measure(*labels);
    GrayScan scan = row.scan();
    measureNecks(*labels, scan, blurOf(row.scan(), {}), measured);
    REQUIRE(measured.bonds.size() == pairs.size());
    Spread errors;
    for (size_t i = 0; i < pairs.size(); ++i) {
      const double gap = -2 * pairs[i].neck, found = measured.bonds[i].neck->gap;
      INFO("noise " << noise << ": " << found << " for " << gap);
      CHECK(found == Approx(gap).margin(0.05 + 1.5 * noise));
      errors.add(found - gap);
    }
    CHECK(std::abs(errors.mean()) < 0.04 + 0.2 * noise);
    CHECK(contactCoordination(measured) == 0.5);  // four of eight bonds, of sixteen grains
  }
}

TEST_CASE("measure_necks: a rod cut across has its own section", "[measure_necks]") {
  const CoordBBox box(Coord(0), Coord(47, 39, 39));
  const auto inRod = [](const Vec3d& p) { return std::hypot(p.y() - 19.6, p.z() - 20.2) < 9; };
  std::vector<float> values;
  for (int z = 0; z < 40; ++z)
    for (int y = 0; y < 40; ++y)
      for (int x = 0; x < 48; ++x) values.push_back(inRod(Vec3d(x, y, z)) ? 1 : 0);
  const auto image = smoothedImage(imageOf({48, 40, 40}, values), 0.8);
  image->read(0, 40, values.data());
  const auto labels = drawLabels(box, [&](const Vec3d& p) {
    return !inRod(p) ? 0 : p.x() < 23.5 ? 1 : 2;
  });
  setDomain(*labels, box);
  Measurements measured = measure(*labels);
  GrayScan scan{imageOf({48, 40, 40}, values), Coord(0)};
  measureNecks(*labels, scan, {1, 0, 0.01, 0.85}, measured);
  REQUIRE(measured.bonds.size() == 1);
  CHECK(measured.bonds[0].neck->area == Approx(M_PI * 81).epsilon(0.02));
  CHECK(measured.bonds[0].neck->normal.x() > 0.9999);
}

TEST_CASE("measure_necks: a scan that is larger than the domain adds nothing", "[measure_necks]") {
  const Row& row = fourPairs();
  const CoordBBox box(Coord(1, 20, 8), Coord(row.size.x - 2, 37, 47));  // cuts grains
  const Coord size = box.dim();
  const auto all = row.sides();
  const auto labels =
      drawLabels(box, [&](const Vec3d& p) { return all->tree().getValue(Coord::round(p)); });
  setDomain(*labels, box);
  std::vector<float> cut;
  for (int z = box.min().z(); z <= box.max().z(); ++z)
    for (int y = box.min().y(); y <= box.max().y(); ++y)
      for (int x = box.min().x(); x <= box.max().x(); ++x)
        cut.push_back(row.grays[(size_t(z) * size_t(row.size.y) + size_t(y)) * size_t(row.size.x) +
                                size_t(x)]);
  GrayScan part{imageOf({size.x(), size.y(), size.z()}, cut), box.min()}, whole = row.scan();
  GrayScan unplaced{imageOf({size.x(), size.y(), size.z()}, cut), Coord(0)};
  const ScanBlur blur{3000, 1000, 0.04, 0.85};
  Measurements byPart = measure(*labels), byWhole = byPart, byUnplaced = byPart;
  measureNecks(*labels, part, blur, byPart);
  measureNecks(*labels, whole, blur, byWhole);
  measureNecks(*labels, unplaced, blur, byUnplaced);
  REQUIRE(byPart.bonds.size() >= 3);
  for (size_t i = 0; i < byPart.bonds.size(); ++i)
    for (const Measurements* by : {&byWhole, &byUnplaced})
      CHECK(by->bonds[i].neck->area == byPart.bonds[i].neck->area);
}

TEST_CASE("measure_necks: grains may be dark, and have to be where the labels are",
          "[measure_necks]") {
  const auto labels = fourPairs().sides();
  Measurements bright = measure(*labels), dark = bright;
  Row row = fourPairs();
  GrayScan scan = row.scan();
  measureNecks(*labels, scan, blurOf(fourPairs().scan(), {}), bright);
  for (float& gray : row.grays) gray = 4000 - gray;
  scan = row.scan();
  measureNecks(*labels, scan, blurOf(fourPairs().scan(), {}), dark);
  CHECK(dark.scan->inside == Approx(1000).epsilon(0.01));
  for (size_t i = 0; i < 4; ++i) {
    CHECK(dark.bonds[i].neck->area == Approx(bright.bonds[i].neck->area).epsilon(1e-4));
    CHECK(dark.bonds[i].neck->confirmed == bright.bonds[i].neck->confirmed);
  }
  std::reverse(row.grays.begin(), row.grays.end());  // all axes the other way
  scan = row.scan();
  CHECK_THROWS_WITH(measureNecks(*labels, scan, blurOf(fourPairs().scan(), {}), dark),
                    Contains("not where the labels have them"));
}

TEST_CASE("measure_necks: beside a flat face nothing is known", "[measure_necks]") {
  const Vec3d center(27.8, 28.2, 22.1), normal(0.6, -0.64, 0.48), across(0.8, 0.48, -0.36);
  const Vec3d along = normal.cross(across);
  const auto holds = [&](const Vec3d& p) {
    const Vec3d q = p - center;
    const double z = q.dot(normal);
    const bool inPlate =
        z <= 0 && z > -14 && std::abs(q.dot(across)) < 18 && std::abs(q.dot(along)) < 18;
    return inPlate || (q - normal * std::sqrt(121.0 - 25)).length() < 11;  // a neck of radius 5
  };
  const ImageSize size{64, 64, 64};
  std::vector<float> values;
  for (int z = 0; z < size.z; ++z)
    for (int y = 0; y < size.y; ++y)
      for (int x = 0; x < size.x; ++x) values.push_back(holds(Vec3d(x, y, z)) ? 3000 : 1000);
  smoothedImage(imageOf(size, values), 0.8)->read(0, size.z, values.data());
  const CoordBBox box(Coord(0), Coord(63));
  const auto labels = drawLabels(box, [&](const Vec3d& p) {
    const bool isSolid = values[(size_t(p.z()) * 64 + size_t(p.y())) * 64 + size_t(p.x())] >= 2000;
    return !isSolid ? 0 : (p - center).dot(normal) > 0 ? 2 : 1;
  });
  setDomain(*labels, box);
  Measurements measured = measure(*labels);
  REQUIRE(measured.bonds.size() == 1);
  GrayScan scan{imageOf(size, values), Coord(0)};
  measureNecks(*labels, scan, {3000, 1000, 0.02, 0.85}, measured);
  const Neck& neck = *measured.bonds[0].neck;
  INFO(neck.area << " +- " << neck.error << ", gap " << neck.gap);
  CHECK(std::isnan(neck.area));
  CHECK(std::isnan(neck.gap));
  CHECK_FALSE(neck.confirmed);
  CHECK(neck.touches());
  CHECK(neck.error > 21);
}

TEST_CASE("measure_necks: refuses another scan, slices and unequal voxels", "[measure_necks]") {
  const auto labels = fourPairs().sides();
  Measurements measured = measure(*labels);
  const ScanBlur blur{3000, 1000, 0.04, 0.85};
  GrayScan other{imageOf({5, 5, 5}, std::vector<float>(125)), Coord(0)};
  CHECK_THROWS_AS(measureNecks(*labels, other, blur, measured), InvalidInput);
  GrayScan scan = fourPairs().scan();
  measured.edges = Vec3d(1, 1, 2);
  CHECK_THROWS_AS(measureNecks(*labels, scan, blur, measured), InvalidInput);
  measured.edges = Vec3d(1);
  measured.grains.clear();
  CHECK_THROWS_AS(measureNecks(*labels, scan, blur, measured), InvalidInput);

  const CoordBBox slice(Coord(0), Coord(19, 19, 0));
  const auto flat = drawLabels(slice, [](const Vec3d& p) { return p.x() < 10 ? 1 : 2; });
  setDomain(*flat, slice);
  Measurements ofSlice = measure(*flat);
  GrayScan one{imageOf({20, 20, 1}, std::vector<float>(400)), Coord(0)};
  CHECK_THROWS_AS(measureNecks(*flat, one, blur, ofSlice), InvalidInput);
}

TEST_CASE("measure_necks: how right areas are", "[measure_necks]") {
  const bool prints = std::getenv("VDB_MADF_PRINT_NECKS") != nullptr;
  const size_t count = prints ? 128 : 16;
  for (const double blur :
       prints ? std::vector<double>{0.5, 0.8, 1, 1.5} : std::vector<double>{0.8})
    for (const double noise :
         prints ? std::vector<double>{0.02, 0.05, 0.1, 0.15} : std::vector<double>{0.05}) {
      const Row row(randomPairs(count, 7), blur, noise);
      const auto mask = MaskGrid::create();
      for (auto p = row.box().begin(); p; ++p)
        if (row.isSolid((*p).asVec3d())) mask->tree().setValueOn(*p);
      setDomain(*mask, row.box());
      const Segmentation segmentation = segment(*mask);
      Measurements measured = measure(segmentation);
      GrayScan scan = row.scan();
      measureNecks(*segmentation.grain, scan, blurOf(row.scan(), {}), measured);
      Spread sharp, fillets, all, labels, angles;
      int gaps = 0, falseNecks = 0, missed = 0, within = 0;
      for (size_t i = 0; i < count; ++i) {
        const Pair& pair = row.pairs[i];
        const BondMeasures* bond = nullptr;  // the largest in the cell
        for (const BondMeasures& b : measured.bonds)
          if (size_t(b.centroid.x()) / kCell == i && (!bond || b.area > bond->area)) bond = &b;
        const bool confirmed = bond && bond->neck->confirmed;
        if (pair.neck < 0) {
          ++gaps;
          falseNecks += confirmed;
          continue;
        }
        missed += !confirmed;
        if (!bond) continue;
        const double truth = M_PI * pair.neck * pair.neck, area = bond->neck->area;
        (pair.fillet > 0 ? fillets : sharp).add(area / truth - 1);
        all.add(area / truth - 1);
        labels.add(bond->area / truth - 1);
        angles.add(std::acos(std::min(1.0, std::abs(bond->neck->normal.dot(pair.normal)))));
        within += std::abs(area - truth) < 2 * bond->neck->error;
      }
      if (prints)
        std::printf(
            "blur %.1f noise %2.0f %%: labels %+5.1f %% | scan %+4.1f %% sd %4.1f %% (sharp "
            "%+4.1f, fillets %+4.1f) | within two errors %3.0f %% | normals %.1f degrees | "
            "gaps taken for necks %d of %d, necks missed %d of %d\n",
            blur, 100 * noise, 100 * labels.mean(), 100 * all.mean(), 100 * all.deviation(),
            100 * sharp.mean(), 100 * fillets.mean(), 100.0 * within / all.count,
            angles.mean() * 180 / M_PI, falseNecks, gaps, missed, int(count) - gaps);
      if (blur > 1 || noise > 0.1) continue;
      CHECK(std::abs(all.mean()) < 0.03);
      CHECK(all.deviation() < 0.08);
      CHECK(std::abs(fillets.mean()) < 0.08);
      CHECK(angles.mean() < 3 * M_PI / 180);
      CHECK(falseNecks <= gaps / 30);
      CHECK(missed == 0);
    }
}
