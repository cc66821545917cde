// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include <cmath>
#include <limits>
#include <map>

#include "support/catch.h"
#include "support/comma_locale.h"
#include "support/memory_image.h"
#include "vdb_madf/scans/histogram.h"

using namespace vdb_madf;
using namespace vdb_madf::test;

namespace {

template <typename T>
Histogram histogramOfRow(const std::vector<T>& samples) {
  return histogramOf(*imageOf<T>({int(samples.size()), 1, 1}, samples));
}

template <typename T>
ImageKind kindOfRow(const std::vector<T>& samples) {
  return kindOf(histogramOfRow(samples));
}

/// The value after which Otsu's criterion cuts, of all values that occur but the last.
double otsuByDefinition(const std::vector<double>& samples) {
  double best = -1, cut = 0;
  for (const double value : samples) {
    double lower = 0, upper = 0, lowerSum = 0, upperSum = 0;
    for (const double v : samples) {
      (v <= value ? lower : upper) += 1;
      (v <= value ? lowerSum : upperSum) += v;
    }
    if (upper == 0) continue;
    const double difference = lowerSum / lower - upperSum / upper;
    const double variance = lower * upper * difference * difference;
    if (variance > best * (1 + 1e-12) || (variance > best * (1 - 1e-12) && value < cut)) {
      best = variance;
      cut = value;
    }
  }
  return cut;
}

template <typename T>
void checkBins(const std::vector<T>& samples) {
  const Histogram histogram = histogramOfRow(samples);
  std::map<int64_t, int64_t> expected;
  int64_t finite = 0;
  for (const T value : samples) {
    if (!std::isfinite(double(value))) continue;
    ++expected[int64_t(std::floor(double(value) / histogram.width))];
    ++finite;
  }
  CHECK(histogram.finite == finite);
  CHECK(histogram.notFinite == int64_t(samples.size()) - finite);
  REQUIRE(histogram.counts.size() <= 65536);
  REQUIRE(!expected.empty());
  CHECK(histogram.first == expected.begin()->first);
  CHECK(int64_t(histogram.counts.size()) == expected.rbegin()->first - histogram.first + 1);
  bool same = true;
  for (size_t i = 0; i < histogram.counts.size(); ++i) {
    const auto found = expected.find(histogram.first + int64_t(i));
    same &= histogram.counts[i] == (found == expected.end() ? 0 : found->second);
  }
  CHECK(same);
  int exponent = 0;
  CHECK(std::frexp(histogram.width, &exponent) == 0.5);  // a power of two
  // Half the width would not do, unless the numbers end there.
  const bool least = histogram.width == 1 && std::is_integral_v<T>;
  const double half = histogram.width / 2;
  CHECK((least || std::floor(histogram.max / half) - std::floor(histogram.min / half) >= 65536));
}

}  // namespace

TEST_CASE("histogram: counts every value in the narrowest bins that suffice", "[histogram]") {
  checkBins(randomNumbers<uint8_t>(3000, 0, 255, 1));
  checkBins(randomNumbers<int16_t>(3000, -30000, 30000, 2));
  checkBins(randomNumbers<int32_t>(3000, -100000, 2000000, 3));
  checkBins<uint32_t>({0, 4294967295u, 5, 5, 70000});
  checkBins<int32_t>({std::numeric_limits<int32_t>::min(), std::numeric_limits<int32_t>::max()});
  const float infinity = std::numeric_limits<float>::infinity();
  std::vector<float> floats;
  for (const int value : randomNumbers<int>(5000, -1000, 1000000, 4))
    floats.push_back(float(value) / 777);
  floats[7] = std::nanf("");
  floats[8] = infinity;
  floats[9] = -infinity;
  checkBins(floats);
  checkBins<double>({1e-200, 3e-200, -2e-200});
  checkBins<double>({-1e308, 1e308, 0});
}

TEST_CASE("histogram: the voxels of few values are counted, however wide the bins are",
          "[histogram]") {
  const Histogram wide = histogramOfRow<uint32_t>({0, 4294967295u, 5, 4294967295u});
  CHECK(wide.few == std::vector<double>{0, 5, 4294967295.0});
  CHECK(wide.fewCounts == std::vector<int64_t>{1, 1, 2});
  CHECK(voxelsAround(wide, 5) == 2);  // 0 and 5 have one bin
  const Histogram fraction = histogramOfRow<float>({0, 1.1F, 0, 0, 1.1F});
  CHECK(fraction.fewCounts == std::vector<int64_t>{3, 2});
  CHECK(voxelsAround(fraction, double(1.1F)) == 2);
  CHECK(voxelsAround(fraction, 7) == 0);
}

TEST_CASE("histogram: has no bins without a finite value", "[histogram]") {
  const Histogram histogram = histogramOfRow<float>({std::nanf(""), std::nanf("")});
  CHECK(histogram.counts.empty());
  CHECK(histogram.notFinite == 2);
  CHECK_FALSE(otsuThreshold(histogram));
  CHECK_FALSE(valleyThreshold(histogram));
  CHECK(kindOf(histogram) == ImageKind::mask);
  CHECK(histogramLine(histogram) == "no finite values");
}

TEST_CASE("histogram: does not depend on how the image is divided", "[histogram]") {
  std::vector<float> samples;
  for (const int value : randomNumbers<int>(60 * 50 * 40, -500, 90000, 5))
    samples.push_back(float(value) / (value % 7 == 0 ? 1e-3F : 13));
  const Histogram whole = histogramOf(*imageOf<float>({60, 50, 40}, samples));
  const Histogram tall = histogramOf(*imageOf<float>({60, 1, 2000}, samples));
  CHECK(whole.width == tall.width);
  CHECK(whole.first == tall.first);
  CHECK(whole.counts == tall.counts);
  CHECK(whole.runs == tall.runs);
}

TEST_CASE("histogram: masks, phases, labels and gray images are told apart", "[histogram]") {
  CHECK(kindOfRow<uint8_t>({0, 0, 0}) == ImageKind::mask);
  CHECK(kindOfRow<uint8_t>({7, 7, 7}) == ImageKind::mask);
  CHECK(kindOfRow<uint8_t>({0, 255, 0}) == ImageKind::mask);
  CHECK(kindOfRow<float>({0, 0.5F, std::nanf("")}) == ImageKind::mask);
  CHECK(kindOfRow<uint8_t>({1, 2, 1, 2}) == ImageKind::phases);
  CHECK(kindOfRow<float>({0, 1, 2, 3}) == ImageKind::phases);
  CHECK(kindOfRow<float>({0, 1, 2.5F, 3}) == ImageKind::gray);
  CHECK(kindOfRow(randomNumbers<uint8_t>(5000, 0, 255, 1)) == ImageKind::gray);
  CHECK(kindOfRow(randomNumbers<uint16_t>(5000, 0, 65535, 1)) == ImageKind::gray);
  CHECK(kindOfRow(randomNumbers<uint8_t>(5000, 0, 9, 1)) == ImageKind::gray);
  // A ramp between two plateaus, as blur leaves it: only the plateaus have runs.
  std::vector<uint8_t> ramp(1000, 0);
  for (int i = 0; i < 60; ++i) ramp.push_back(uint8_t(4 * i));
  ramp.insert(ramp.end(), 1000, 255);
  CHECK(kindOfRow(ramp) == ImageKind::gray);
  std::vector<int32_t> labels(100, 0);
  for (int label = 1; label <= 100000; label += 999)
    labels.insert(labels.end(), size_t(3 + label % 4), label);
  CHECK(kindOfRow(labels) == ImageKind::labels);
  CHECK(kindOfRow(std::vector<float>(labels.begin(), labels.end())) == ImageKind::labels);
}

TEST_CASE("histogram: gray values are strewn over the image, labels lie together", "[histogram]") {
  constexpr int kSide = 24;
  const size_t voxels = size_t(kSide) * kSide * kSide;
  for (const int most : {255, 65535})
    CHECK(valueSpread(*imageOf<uint16_t>({kSide, kSide, kSide},
                                         randomNumbers<uint16_t>(voxels, 0, most, 1))) > 0.3);
  // Bars of two voxels along any axis: of 23 steps one, along one axis of three.
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<int32_t> bars;
    for (int i = 0; i < int(voxels); ++i) {
      const int step = axis == 0 ? 1 : axis == 1 ? kSide : kSide * kSide;
      bars.push_back(1 + i - i / step % 2 * step);
    }
    CHECK(valueSpread(*imageOf<int32_t>({kSide, kSide, kSide}, bars)) == Approx(1.0 / 69));
  }
  CHECK(valueSpread(*imageOf<uint8_t>({4, 1, 1}, {0, 0, 1, 2})) == 1);
  CHECK(valueSpread(*imageOf<uint8_t>({4, 1, 1}, {3, 0, 0, 3})) == 1);
}

TEST_CASE("histogram: Otsu's threshold is that of the definition", "[histogram]") {
  for (unsigned seed = 1; seed <= 60; ++seed) {
    CAPTURE(seed);
    auto samples = randomNumbers<int16_t>(40, -60, int(seed), seed);
    const auto more = randomNumbers<int16_t>(10 + seed % 30, 100, 180, seed + 1000);
    samples.insert(samples.end(), more.begin(), more.end());
    const double cut = otsuByDefinition({samples.begin(), samples.end()});
    const Histogram histogram = histogramOfRow(samples);
    const auto threshold = otsuThreshold(histogram);
    REQUIRE(threshold);
    int64_t above = 0;
    for (const int16_t value : samples) {
      CHECK((value >= *threshold) == (value > cut));
      above += value > cut;
    }
    CHECK(voxelsFrom(histogram, *threshold) == above);
  }
  CHECK(otsuThreshold(histogramOfRow<uint8_t>({0, 0, 255})) == 128.0);
  CHECK(otsuThreshold(histogramOfRow<uint8_t>({4, 5})) == 5.0);
  CHECK_FALSE(otsuThreshold(histogramOfRow<uint8_t>({5, 5})));
}

TEST_CASE("histogram: a valley lies between two modes, or there is none", "[histogram]") {
  std::vector<uint8_t> two;
  for (int i = -20; i <= 20; ++i) {
    two.insert(two.end(), size_t(100 - 4 * std::abs(i)), uint8_t(60 + i));
    two.insert(two.end(), size_t(60 - 2 * std::abs(i)), uint8_t(140 + i));
  }
  const auto valley = valleyThreshold(histogramOfRow(two));
  REQUIRE(valley);
  CHECK(*valley > 80);
  CHECK(*valley < 121);
  std::vector<uint8_t> one;
  for (int i = -20; i <= 20; ++i)
    one.insert(one.end(), size_t(100 - 4 * std::abs(i)), uint8_t(60 + i));
  CHECK_FALSE(valleyThreshold(histogramOfRow(one)));
  // Nor is a range too large that is no finite number itself.
  std::vector<double> huge;
  for (const uint8_t value : two) huge.push_back((value - 100) * 1.7e306);
  const auto hugeValley = valleyThreshold(histogramOfRow(huge));
  REQUIRE(hugeValley);
  CHECK(*hugeValley > -20 * 1.7e306);
  CHECK(*hugeValley < 21 * 1.7e306);
}

TEST_CASE("histogram: a line shows it between its ends", "[histogram]") {
  std::vector<uint16_t> samples(1000, 100);
  samples.insert(samples.end(), 250, 120);
  CHECK(histogramLine(histogramOfRow(samples), 5) == "100 |@   +| 120");
  CHECK(histogramLine(histogramOfRow<uint8_t>({3, 3}), 5) == "3 |@| 3");
  // The ends differ, however large the values are.
  const std::string line = histogramLine(histogramOfRow<double>({1e7 + 4, 1e7 + 35}), 5);
  CHECK(line == "10000004 |@   @| 10000035");
}

TEST_CASE("histogram: labels are counted one by one, however wide the bins are", "[histogram]") {
  for (const int32_t step : {1, 7, 20000001}) {
    CAPTURE(step);
    std::vector<int32_t> samples;
    for (int i = 0; i < 90; ++i) samples.insert(samples.end(), 4, i % 30 * step);
    const Histogram histogram = histogramOfRow(samples);
    CHECK(countLabels(histogram, *imageOf<int32_t>({360, 1, 1}, samples)) == 29);
  }
}

TEST_CASE("histogram: the padding at the ends of rows is also left out", "[histogram]") {
  std::vector<int16_t> samples(3 * 3 * 4, -5);
  for (int z = 0; z < 4; ++z) samples[size_t(9 * z + 4)] = int16_t(z);
  const Histogram histogram = histogramOf(*imageOf<int16_t>({3, 3, 4}, samples));
  CHECK(histogram.corner == -5.0);
  CHECK(histogram.padding == 32);
  const auto inside = histogram.inside;
  REQUIRE(inside);
  CHECK(inside->counts == std::vector<int64_t>(4, 1));
  CHECK(inside->runs == std::vector<int64_t>(4, 1));
  CHECK(inside->first == 0);
  CHECK(inside->min == 0);
  CHECK(inside->max == 3);
  CHECK(inside->finite == 4);
  CHECK(otsuThreshold(*inside) == 2.0);
  samples[9 * 3 + 8] = 7;
  CHECK_FALSE(histogramOf(*imageOf<int16_t>({3, 3, 4}, samples)).corner);
  CHECK_FALSE(histogramOfRow<uint8_t>({3, 3}).inside);
  // A value in the place of the greatest.
  const auto low = histogramOf(*imageOf<uint8_t>({3, 1, 1}, {9, 4, 9})).inside;
  REQUIRE(low);
  CHECK(low->counts == std::vector<int64_t>{1});
  CHECK(low->max == 4);
  // Between others, the same value is none of the padding.
  const Histogram between = histogramOf(*imageOf<uint8_t>({6, 1, 1}, {9, 9, 4, 9, 7, 9}));
  CHECK(between.padding == 3);
  REQUIRE(between.inside);
  CHECK(between.inside->finite == 3);
  CHECK(between.inside->max == 9);
}

TEST_CASE("histogram: its line has points in a locale with a comma", "[histogram]") {
  const test::CommaLocale locale;
  if (!locale.isSet()) return;
  REQUIRE_THAT(histogramLine(histogramOfRow<float>({0.25f, 0.5f, 0.75f})),
               vdb_madf::test::Contains("0.5") || vdb_madf::test::Contains("0.2"));
  REQUIRE_THAT(histogramLine(histogramOfRow<float>({0.25f, 0.5f, 0.75f})),
               !vdb_madf::test::Contains(","));
}
