// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/intensity/measure_gray.h"

#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <map>
#include <set>

#include "support/catch.h"
#include "support/known_bodies.h"
#include "support/label_slabs.h"
#include "support/memory_image.h"
#include "support/slab_objects.h"
#include "support/temporary_folder.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/grids/grid_metadata.h"
#include "vdb_madf/labels/reduced_labels.h"
#include "vdb_madf/measure/columns.h"
#include "vdb_madf/segmentation/initialize.h"
#include "vdb_madf/vdb/write_vdb.h"

using namespace vdb_madf;
using namespace vdb_madf::test;

namespace {

/// Grains that are cells of a few points, with gaps; over the box.
Int32Grid::Ptr randomLabels(const CoordBBox& box, uint64_t seed) {
  Rng rng(seed);
  std::vector<Vec3d> seeds;
  for (int i = 0; i < 7; ++i)
    seeds.push_back(box.min().asVec3d() + randomPoint(rng) * box.dim().asVec3d());
  const auto labels = drawLabels(box, [&](const Vec3d& p) {
    if (rng.chance(0.3)) return 0;
    const auto nearest = std::min_element(
        seeds.begin(), seeds.end(),
        [&](const Vec3d& a, const Vec3d& b) { return (a - p).lengthSqr() < (b - p).lengthSqr(); });
    return 5 * int(nearest - seeds.begin()) + 1;
  });
  setDomain(*labels, box);
  return labels;
}

GrayValues valuesOf(std::vector<double> samples) {
  samples.erase(
      std::remove_if(samples.begin(), samples.end(), [](double s) { return !std::isfinite(s); }),
      samples.end());
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto n = double(samples.size());
  GrayValues values{int64_t(n), nan, nan, nan, nan, nan};
  if (samples.empty()) return values;
  std::sort(samples.begin(), samples.end());
  long double sum = 0, squares = 0;
  for (const double sample : samples) sum += sample;
  for (const double sample : samples) squares += std::pow(sample - sum / n, 2);
  values.mean = double(sum / n);
  values.deviation = double(std::sqrt(squares / n));
  values.minimum = samples.front();
  values.maximum = samples.back();
  values.median = (samples[(samples.size() - 1) / 2] + samples[samples.size() / 2]) / 2;
  return values;
}

void requireSame(const GrayValues& found, const GrayValues& expected) {
  CHECK(found.voxels == expected.voxels);
  if (expected.voxels == 0) {
    CHECK(std::isnan(found.mean));
    CHECK(std::isnan(found.deviation));
    CHECK(std::isnan(found.minimum));
    CHECK(std::isnan(found.median));
    return;
  }
  CHECK(found.mean == Approx(expected.mean).epsilon(1e-13));
  CHECK(found.deviation == Approx(expected.deviation).epsilon(1e-10));
  CHECK(found.minimum == expected.minimum);
  CHECK(found.maximum == expected.maximum);
  CHECK(found.median == expected.median);
}

/// By the definitions, voxel by voxel; valueOf(Coord).
template <typename ValueOf>
void requireDefinitions(const Int32Grid& labels, const Measurements& measured,
                        const ValueOf& valueOf) {
  std::map<int32_t, std::vector<double>> ofGrains;
  std::map<std::pair<int32_t, int32_t>, std::set<Coord>> besideBonds;
  const auto accessor = labels.getConstAccessor();
  for (auto voxel = labels.cbeginValueOn(); voxel; ++voxel) {
    const Coord p = voxel.getCoord();
    ofGrains[*voxel].push_back(valueOf(p));
    for (int side = 0; side < 6; ++side) {
      Coord q = p;
      q[side / 2] += side % 2 ? 1 : -1;
      const int32_t other = accessor.getValue(q);
      if (other > 0 && other != *voxel) besideBonds[std::minmax(int32_t(*voxel), other)].insert(p);
    }
  }
  REQUIRE(measured.extra.gray);
  REQUIRE(ofGrains.size() == measured.grains.size());
  for (const GrainMeasures& grain : measured.grains)
    requireSame(grain.gray.value(), valuesOf(ofGrains.at(grain.id)));
  REQUIRE(measured.bonds.size() > 0);
  for (const BondMeasures& bond : measured.bonds) {
    std::vector<double> samples;
    for (const Coord& p : besideBonds.at({bond.first, bond.second})) samples.push_back(valueOf(p));
    requireSame(bond.gray.value(), valuesOf(samples));
  }
}

template <typename T>
std::vector<T> wideNumbers(size_t count) {
  Rng rng(count);
  std::vector<T> numbers(count);
  for (T& number : numbers) {
    const uint64_t bits = rng.next();
    if constexpr (std::is_integral_v<T>)
      number = T(bits);
    else
      number = T(double(bits % 1000003) / 7 - 50000);
  }
  return numbers;
}

std::vector<double> grayNumbers(const Measurements& measured) {
  std::vector<double> numbers;
  for (const auto& columns :
       {grainColumns(measured.grains, measured.extra), bondColumns(measured.bonds, measured.extra)})
    for (const MeasureColumn& column : columns)
      if (column.name.compare(0, 5, "gray_") == 0)
        numbers.insert(numbers.end(), column.values.begin(), column.values.end());
  return numbers;
}

}  // namespace

TEMPLATE_TEST_CASE("measure_gray: by the definitions, of each type of samples", "[measure_gray]",
                   uint8_t, int8_t, uint16_t, int16_t, uint32_t, int32_t, float, double) {
  const ImageSize size{21, 17, 26};
  const CoordBBox box(Coord(0), Coord(20, 16, 25));
  const auto labels = randomLabels(box, 3);
  auto samples = wideNumbers<TestType>(21 * 17 * 26);
  if constexpr (std::is_floating_point_v<TestType>) {
    samples[5] = std::numeric_limits<TestType>::quiet_NaN();
    for (size_t i = 900; i < 950; ++i) samples[i] = std::numeric_limits<TestType>::infinity();
  }
  GrayScan scan{imageOf(size, samples), Coord(0)};
  MeasureOptions options;
  options.minFaces = 3;
  Measurements measured = measure(*labels, options);
  measureGray(*labels, scan, measured);
  requireDefinitions(*labels, measured, [&](const Coord& p) {
    return double(samples[size_t((p.z() * 17 + p.y()) * 21 + p.x())]);
  });
}

TEST_CASE("measure_gray: grids of a VDB file, from any voxel on", "[measure_gray]") {
  initialize();
  const TemporaryFolder folder;
  const CoordBBox box(Coord(-9, 3, -20), Coord(10, 22, -3));
  const auto labels = randomLabels(box, 8);
  const auto valueOf = [](const Coord& p) { return p.z() > -5 ? 2.5 : p.x() + 0.25 * p.y(); };
  const auto grid = FloatGrid::create(2.5f);
  for (auto p = box.begin(); p; ++p)
    if ((*p).z() <= -5) grid->tree().setValue(*p, float(valueOf(*p)));
  setDomain(*grid, box);
  grid->setName("density");
  writeVdb(folder.file("scan.vdb"), {grid});
  GrayScan scan = openGrayScan(folder.file("scan.vdb"));
  CHECK(scan.box() == box);
  Measurements measured = measure(*labels);
  measureGray(*labels, scan, measured);
  requireDefinitions(*labels, measured, valueOf);
  VolumeOptions named;
  named.grid = "fog";
  CHECK_THROWS_WITH(openGrayScan(folder.file("scan.vdb"), named),
                    vdb_madf::test::Contains("'fog'"));
}

TEST_CASE("measure_gray: all voxels of a float scan without numbers", "[measure_gray]") {
  const CoordBBox box(Coord(0), Coord(9));
  const auto labels = randomLabels(box, 2);
  GrayScan scan{imageOf(ImageSize{10, 10, 10},
                        std::vector<float>(1000, std::numeric_limits<float>::quiet_NaN())),
                Coord(0)};
  Measurements measured = measure(*labels);
  measureGray(*labels, scan, measured);
  for (const GrainMeasures& grain : measured.grains) {
    CHECK(grain.gray->voxels == 0);
    CHECK(std::isnan(grain.gray->mean));
  }
}

TEST_CASE("measure_gray: the same bits with one thread and with four", "[measure_gray]") {
  const auto labels = randomLabels({Coord(0), Coord(29, 30, 31)}, 6);
  const auto samples = wideNumbers<float>(30 * 31 * 32);
  const auto bits = [&](int threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, size_t(threads));
    GrayScan scan{imageOf(ImageSize{30, 31, 32}, samples), Coord(0)};
    Measurements measured = measure(*labels);
    measureGray(*labels, scan, measured);
    return grayNumbers(measured);
  };
  const auto one = bits(1), four = bits(4);
  REQUIRE(one.size() == four.size());
  CHECK(std::memcmp(one.data(), four.data(), one.size() * sizeof(double)) == 0);
}

TEST_CASE("measure_gray: the box of the scan has to hold that of the labels", "[measure_gray]") {
  const CoordBBox box(Coord(0), Coord(9, 10, 11));
  auto labels = randomLabels(box, 4);
  const auto measureWith = [&](const ImageSize& size) {
    GrayScan scan{imageOf(size, std::vector<uint8_t>(size_t(size.x * size.y * size.z), 7)),
                  Coord(0)};
    Measurements measured = measure(*labels);
    measureGray(*labels, scan, measured);
    return measured;
  };
  CHECK(measureWith({10, 11, 12}).grains.at(0).gray->mean == 7);
  CHECK(measureWith({20, 22, 24}).grains.at(0).gray->mean == 7);  // of which they were cropped
  for (const ImageSize size : {ImageSize{10, 11, 11}, ImageSize{12, 11, 10}})
    CHECK_THROWS_WITH(
        measureWith(size),
        vdb_madf::test::Contains("samples.tif: has ") &&
            vdb_madf::test::Contains("of a scan of 10x11x12 voxels: give the one that"));
  // Parts of a scan.
  const CoordBBox part(Coord(3, 0, 0), Coord(9, 10, 11));
  labels = randomLabels(part, 4);
  CHECK(measureWith({10, 11, 12}).grains.at(0).gray->mean == 7);
  CHECK(measureWith({30, 31, 32}).grains.at(0).gray->mean == 7);
  CHECK(measureWith({7, 11, 12}).grains.at(0).gray->mean == 7);  // cropped as they were
  CHECK_THROWS_WITH(measureWith({10, 11, 9}),
                    vdb_madf::test::Contains("7x11x12 voxels from 3,0,0 on"));
  labels = randomLabels(box, 4);
  MaskGrid region;
  region.fill(box, true);
  region.tree().setValueOff(Coord(9, 10, 11));
  labels->tree().setValueOff(Coord(9, 10, 11), 0);
  setDomain(*labels, Domain(region.tree()));
  CHECK(measureWith({20, 22, 24}).grains.at(0).gray->mean == 7);
  labels = drawLabels(box, [](const Vec3d&) { return 1; });  // without a domain
  CHECK_THROWS_WITH(measureWith({10, 11, 12}),
                    vdb_madf::test::Contains("domain of the labels is unknown"));
}

TEMPLATE_TEST_CASE("measure_gray: labels in slabs have the bits of the whole", "[measure_gray]",
                   uint8_t, int32_t, float) {
  const Coord first(-3, 5, -13);
  for (uint64_t seed = 1; seed <= 40; ++seed) {
    INFO("seed " << seed);
    Rng rng(seed);
    const ImageSize size{rng.between(1, 25), rng.between(1, 25), rng.between(1, 60)};
    const CoordBBox box(first, first.offsetBy(size.x - 1, size.y - 1, size.z - 1));
    const auto labels = randomLabels(box, seed);
    auto samples = wideNumbers<TestType>(size_t(size.x) * size_t(size.y) * size_t(size.z));
    if constexpr (std::is_floating_point_v<TestType>)
      for (size_t i = 0; i < samples.size(); i += 7)
        samples[i] = std::numeric_limits<TestType>::quiet_NaN();
    const Measurements measured = measure(*labels);
    const auto bits = [&](const auto& cutOrNot) {
      GrayScan scan{imageOf(size, samples), first};
      Measurements result = measured;
      for (BondMeasures& bond : result.bonds) bond.gray.emplace();  // of another scan
      measureGray(cutOrNot, scan, result);
      return grayNumbers(result);
    };
    const std::vector<double> whole = bits(*labels);
    for (const auto& cuts : {randomCuts(box, rng), std::vector<int>{-16, 56}}) {
      const std::vector<double> cut = bits(inSlabs(labels, cuts));
      REQUIRE(cut.size() == whole.size());
      REQUIRE(std::memcmp(cut.data(), whole.data(), cut.size() * sizeof(double)) == 0);
    }
  }
}

TEST_CASE("measure_gray: measures of other labels are refused", "[measure_gray]") {
  const CoordBBox box(Coord(0), Coord(9, 10, 11));
  const auto labels = randomLabels(box, 4);
  const Measurements measured = measure(*labels);
  const auto refuses = [&](const Int32Grid::Ptr& others) {
    GrayScan scan{imageOf(ImageSize{10, 11, 12}, std::vector<uint8_t>(10 * 11 * 12)), Coord(0)};
    Measurements result = measured;
    CHECK_THROWS_WITH(measureGray(inSlabs(others, {0, 8, 16}), scan, result),
                      vdb_madf::test::Contains("not the labels that were measured"));
    CHECK_FALSE(result.extra.gray);
  };
  refuses(drawLabels(box, [](const Vec3d&) { return 1; }));
  refuses(drawLabels(box, [](const Vec3d&) { return 2; }));
  refuses(drawLabels(box, [](const Vec3d&) { return 1000; }));
}

TEST_CASE("measure_gray: labels without a voxel", "[measure_gray]") {
  const auto labels = Int32Grid::create(0);
  setDomain(*labels, CoordBBox(Coord(0), Coord(9)));
  GrayScan scan{imageOf(ImageSize{10, 10, 10}, std::vector<uint8_t>(1000)), Coord(0)};
  Measurements measured = measure(*labels);
  measureGray(*labels, scan, measured);
  CHECK(measured.extra.gray);
  CHECK(measured.grains.empty());
}

TEST_CASE("gray_scan: reduced labels of a part do not say where in the scan they lie",
          "[measure_gray]") {
  const CoordBBox box(Coord(6, 4, 2), Coord(25, 23, 21)), scan(Coord(0), Coord(39));
  const auto labels = randomLabels(box, 3);
  CHECK(noteOnScan("s.tif", scan, std::nullopt, *labels).empty());
  const auto reduced = reduceLabels(*labels, 2);
  CHECK_THROWS_WITH(noteOnScan("s.tif", scan, std::nullopt, *reduced),
                    vdb_madf::test::Contains("count voxels of their own"));
  CHECK(noteOnScan("s.tif", boxOf(*reduced), std::nullopt, *reduced).empty());
  setVoxelSize(*labels, VoxelSize(1e-5));
  const auto sized = reduceLabels(*labels, 2);
  CHECK(noteOnScan("s.tif", scan, VoxelSize(2e-5), *sized).empty());
  CHECK_THROWS_AS(noteOnScan("s.tif", scan, VoxelSize(1e-5), *sized), InvalidInput);
  reduced->insertMeta("madf_grains", openvdb::Int64Metadata(7));  // segmented in such voxels
  CHECK_THROWS_AS(noteOnScan("s.tif", scan, std::nullopt, *reduced), InvalidInput);
  MaskTree round;
  round.sparseFill(box, true);
  round.setValueOff(box.min());
  setDomain(*labels, Domain(round));
  CHECK_THROWS_AS(noteOnScan("s.tif", scan, std::nullopt, *reduceLabels(*labels, 2)), InvalidInput);
}
