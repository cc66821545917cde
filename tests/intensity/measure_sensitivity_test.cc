// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/intensity/measure_sensitivity.h"

#include <algorithm>
#include <random>

#include "support/catch.h"
#include "support/known_bodies.h"
#include "support/memory_image.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/grids/grid_metadata.h"
#include "vdb_madf/grids/object_keys.h"
#include "vdb_madf/scans/image_object.h"
#include "vdb_madf/segmentation/segment.h"
#include "vdb_madf/segmentation/segmentation_metadata.h"

using namespace vdb_madf;
using namespace vdb_madf::test;
using vdb_madf::test::Contains;

namespace {

constexpr ImageSize kBallsSize{56, 28, 28};

/// Two balls of gray value 3000 in 1000, which voxels of another value bridge.
std::vector<float> bridgedBalls(float bridge) {
  std::vector<float> values;
  for (int z = 0; z < 28; ++z)
    for (int y = 0; y < 28; ++y)
      for (int x = 0; x < 56; ++x) {
        const double d = std::hypot(y - 13.6, z - 14.2);
        const bool in = std::hypot(d, x - 15) < 10 || std::hypot(d, x - 41) < 10;
        values.push_back(in ? 3000 : d < 4 && x > 15 && x < 41 ? bridge : 1000);
      }
  return values;
}

/// The labels and numbers of a threshold, with the scan that they were made of.
struct Sample {
  std::vector<float> values;
  GrayOptions gray;
  Int32Grid::Ptr labels;

  Sample(std::vector<float> grays, double threshold, const GrayOptions& options = {})
      : values(std::move(grays)), gray(options) {
    const auto image = [this] { return imageOf(kBallsSize, values); };
    labels = segment(*imageObject(image, Selection::threshold(threshold), gray).mask).grain;
  }
  Measurements recurring(const SensitivityOptions& options) const {
    Measurements measured = measure(*labels, options.measure);
    measureSensitivity(
        *labels,
        [this] {
          return GrayScan{imageOf(kBallsSize, values), Coord(0)};
        },
        options, measured);
    return measured;
  }
};

SensitivityOptions fixed() {
  SensitivityOptions options;
  options.runs = 5;
  options.threshold = options.smooth = options.strictness = 0;
  options.gamma = 0;
  return options;
}

}  // namespace

TEST_CASE("measure_sensitivity: the same choices give the same again", "[measure_sensitivity]") {
  GrayOptions gray;
  gray.median = 1;
  gray.smooth = 0.4;
  gray.despeckle = 5;
  const Sample sample(bridgedBalls(2000), 1900, gray);
  const Measurements m = sample.recurring(fixed());
  REQUIRE(m.grains.size() >= 2);
  REQUIRE_FALSE(m.bonds.empty());
  for (const GrainMeasures& grain : m.grains) {
    CHECK(grain.recurrence->share == 1);
    CHECK(grain.recurrence->deviation == 0);
  }
  for (const BondMeasures& bond : m.bonds) CHECK(bond.recurrence->share == 1);
  REQUIRE(m.sensitivity->intervals.size() == 7);
  const auto shows = [&](size_t i, const std::string& name, double value) {
    const MeanInterval& interval = m.sensitivity->intervals[i];
    CAPTURE(name);
    CHECK(interval.name == name);
    CHECK(*interval.mean == Approx(value));
    CHECK(*interval.low == *interval.high);
  };
  shows(0, "grains", double(m.grains.size()));
  shows(1, "grain_diameter_d50_by_number", diameterPercentile(m.grains, 0.5, false));
  shows(3, "solid_fraction", m.sample.objectFraction);
  shows(4, "specific_surface", m.sample.specificSurface);
  shows(5, "mean_coordination", m.sample.meanCoordination);
}

TEST_CASE("measure_sensitivity: runs are segmented with the boundary of the labels",
          "[measure_sensitivity]") {
  std::mt19937 random(1);  // many grains that faces cut
  std::vector<float> values = bridgedBalls(1000);
  for (float& value : values) value = float(random() % 1000);
  GrayOptions gray;
  gray.smooth = 2;
  const Sample sample(values, 500, gray);
  SensitivityOptions options = fixed();
  options.measure.boundary = Boundary::closed;
  const Measurements m = sample.recurring(options);
  for (const GrainMeasures& grain : m.grains) CHECK(grain.recurrence->share == 1);
  CHECK(*m.sensitivity->intervals[4].mean == Approx(m.sample.specificSurface));
}

TEST_CASE("measure_sensitivity: a bond is there in the runs whose threshold the bridge exceeds",
          "[measure_sensitivity]") {
  // Of 1500 by 400: 1500, 1300, 1700, 1200 and 1600, by halves, quarters and eighths.
  SensitivityOptions options = fixed();
  options.threshold = 400;
  for (const auto& [bridge, share] : {std::pair{1550, 0.6}, {1650, 0.8}, {1750, 1.0}}) {
    CAPTURE(bridge);
    const Sample sample(bridgedBalls(float(bridge)), 1500);
    const Measurements m = sample.recurring(options);
    const auto across = std::find_if(m.bonds.begin(), m.bonds.end(), [&](const BondMeasures& b) {
      return b.first == 1 && b.second == int32_t(m.grains.size());
    });
    REQUIRE(m.grains.size() == 2);
    REQUIRE(across != m.bonds.end());
    CHECK(across->recurrence->share == Approx(share));
    CHECK(across->recurrence->deviation == 0);
    CHECK(m.grains[0].recurrence->share == 1);
    CHECK(m.sensitivity->threshold.low == 1100);
    CHECK(m.sensitivity->threshold.high == 1900);
    const MeanInterval& coordination = m.sensitivity->intervals[5];
    CHECK(*coordination.mean == Approx(share));
    CHECK((*coordination.low < 0.5) == (share < 1));
  }
}

TEST_CASE("measure_sensitivity: runs without a grain, and what cannot be run",
          "[measure_sensitivity]") {
  const Sample sample(bridgedBalls(2000), 2600);
  SensitivityOptions options = fixed();
  options.threshold = 1200;  // 2600, 2000, 3200, 1700 and 2900: one of them above all values
  const Measurements m = sample.recurring(options);
  CHECK(*m.sensitivity->intervals[0].low < 1);
  CHECK(*m.sensitivity->intervals[3].low < 0.1);
  for (const size_t i : {1, 2, 4}) CHECK(*m.sensitivity->intervals[i].low > 0.05);
  options.threshold = 2400;
  CHECK_THROWS_WITH(sample.recurring(options),
                    Contains("run 4 (threshold 800, smooth 0, strictness 11, gamma 1): ") &&
                        Contains("the object fills the whole domain") && Contains("; vary less"));
  options.threshold = 0;
  options.smooth = 40;
  CHECK(sample.recurring(options).sensitivity->smooth.high == 20);
  CHECK_THROWS_WITH(options.vary("strictness", 1e6), Contains("strictness must be at most 200000"));
  CHECK(options.vary("threshold", 1e6));
}

TEST_CASE("measure_sensitivity: of a dark object and of hysteresis", "[measure_sensitivity]") {
  std::vector<float> dark = bridgedBalls(1800);
  for (float& value : dark) value = -value;
  const auto image = [&] { return imageOf(kBallsSize, dark); };
  Selection selection = Selection::threshold(-1500);
  selection.invert = true;
  GrayOptions gray;
  Sample sample(bridgedBalls(1800), 2500);
  for (const bool hysteresis : {false, true}) {
    CAPTURE(hysteresis);
    gray.low = hysteresis ? std::optional<double>(1700) : std::nullopt;
    sample.values = hysteresis ? bridgedBalls(1800) : dark;
    sample.labels = hysteresis ? Sample(sample.values, 2500, gray).labels
                               : segment(*imageObject(image, selection, gray).mask).grain;
    const Measurements m = sample.recurring(fixed());
    REQUIRE(m.bonds.size() == 1);
    CHECK(m.bonds[0].recurrence->share == 1);
    CHECK(*m.sensitivity->intervals[3].mean == Approx(m.sample.objectFraction));
  }
}

TEST_CASE("measure_sensitivity: refuses a scan of which the threshold makes another object",
          "[measure_sensitivity]") {
  Sample sample(bridgedBalls(1800), 1500);
  const std::vector<float> own = sample.values;
  for (const double factor : {1 / 256., 0.8, 1.6}) {
    CAPTURE(factor);
    for (size_t i = 0; i < own.size(); ++i) sample.values[i] = float(factor * own[i]);
    CHECK_THROWS_WITH(sample.recurring(fixed()), Contains("make another object of it, ") &&
                                                     Contains(" % of its voxels are others"));
  }
  sample.values = own;
  for (int i = 0; i < 6; ++i) sample.values[size_t(i)] = 3000;  // beside 8,500
  CHECK(sample.recurring(fixed()).bonds[0].recurrence->share == 1);
}

TEST_CASE("measure_sensitivity: refuses labels that do not tell how they were made",
          "[measure_sensitivity]") {
  Sample sample(bridgedBalls(1800), 1500);
  SensitivityOptions options = fixed();
  options.runs = 4;
  CHECK_THROWS_WITH(sample.recurring(options), Contains("from 5 to 1000"));
  options.runs = 5;
  options.threshold.reset();
  CHECK_THROWS_WITH(sample.recurring(options), Contains("is no gray scan"));
  options.threshold = 10;
  const Int32Grid::Ptr labels = sample.labels;
  sample.labels = labels->deepCopy();
  sample.labels->removeMeta("madf_strictness");
  CHECK_THROWS_WITH(sample.recurring(options), Contains("merged by score"));
  sample.labels = labels->deepCopy();
  sample.labels->removeMeta(kThresholdKey);
  CHECK_THROWS_WITH(sample.recurring(options), Contains("the threshold of a scan"));
  sample.labels = labels->deepCopy();
  sample.labels->insertMeta("madf_edits", openvdb::StringMetadata("drop 1"));
  CHECK_THROWS_WITH(sample.recurring(options), Contains("these were edited"));
  // A part of them, with counts that are brought up to date or not.
  sample.labels = labels->deepCopy();
  sample.labels->clip(CoordBBox(Coord(0), Coord(40, 27, 27)));
  setDomain(*sample.labels, CoordBBox(Coord(0), Coord(40, 27, 27)));
  for (int updated = 0; updated < 2; ++updated) {
    CHECK_THROWS_WITH(sample.recurring(options), Contains("not all that was segmented"));
    updateCounts(*sample.labels, 2, true);
  }
  sample.labels = labels->deepCopy();
  setDomain(*sample.labels, CoordBBox(Coord(0), Coord(55, 27, 28)));
  CHECK_THROWS_AS(sample.recurring(options), InvalidInput);
}
