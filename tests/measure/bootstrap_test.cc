// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

// tests/programs/measures.py compares the numbers with NumPy's, draw by draw.

#include "vdb_madf/measure/bootstrap.h"

#include <cmath>
#include <string>
#include <string_view>

#include "support/catch.h"
#include "support/random_volume.h"
#include "vdb_madf/base/errors.h"

using namespace vdb_madf;
using namespace vdb_madf::test;

namespace {

/// Grains in a row, each with a bond to the next.
struct Chain {
  std::vector<GrainMeasures> grains;
  std::vector<BondMeasures> bonds;

  Chain(int count, uint64_t seed) {
    Rng rng(seed);
    for (int i = 0; i < count; ++i) {
      GrainMeasures grain;
      grain.id = 3 * i + 2;
      grain.equivalentDiameter = 5 + 10 * rng.unit();
      grain.volume = M_PI / 6 * std::pow(grain.equivalentDiameter, 3);
      grain.sphericity = 0.5 + 0.5 * rng.unit();
      grain.freeArea = 100 * rng.unit();
      grain.coordination = (i > 0) + (i + 1 < count);
      grain.edgeWeight = i % 5 ? 1 + rng.unit() : 0;
      grain.shape = GrainShape{0, 0, (1.1 + 0.3 * rng.unit()) * grain.volume};
      grains.push_back(grain);
    }
    for (int i = 1; i < count; ++i) {
      BondMeasures bond;
      bond.first = grains[size_t(i) - 1].id;
      bond.second = grains[size_t(i)].id;
      bond.equivalentRadius = 2;
      bonds.push_back(bond);
    }
  }
};

const MeanInterval& find(const std::vector<MeanInterval>& means, std::string_view name) {
  for (const MeanInterval& mean : means)
    if (mean.name == name) return mean;
  throw std::runtime_error("no " + std::string(name));
}

}  // namespace

TEST_CASE("bootstrap: the means are those of the sample, and lie in their intervals",
          "[bootstrap]") {
  const Chain chain(150, 4);
  const auto means = bootstrapMeans(chain.grains, chain.bonds, {true, false, true}, 500);
  double diameters = 0, volumes = 0, free = 0, ratios = 0, weights = 0, weighted = 0, solidity = 0;
  for (const GrainMeasures& grain : chain.grains) {
    diameters += grain.equivalentDiameter / 150;
    volumes += grain.volume;
    free += grain.freeArea;
    solidity += grain.solidity() / 150;
    weights += grain.edgeWeight;
    weighted += grain.edgeWeight * grain.equivalentDiameter;
  }
  for (size_t i = 1; i < 150; ++i)
    ratios += 4 /
              std::min(chain.grains[i - 1].equivalentDiameter, chain.grains[i].equivalentDiameter) /
              149;
  std::string names;
  for (const MeanInterval& mean : means) {
    CAPTURE(mean.name);
    names += mean.name + " ";
    CHECK(mean.low.value() <= mean.mean.value());
    CHECK(mean.high.value() >= mean.mean.value());
    CHECK(mean.low.value() < mean.high.value());
  }
  CHECK(names ==
        "grain_diameter_mean grain_volume_mean sphericity_mean specific_surface "
        "mean_coordination bond_to_grain_ratio solidity_mean corrected_grain_diameter_mean ");
  CHECK(find(means, "grain_diameter_mean").mean.value() == Approx(diameters));
  CHECK(find(means, "grain_volume_mean").mean.value() == Approx(volumes / 150));
  CHECK(find(means, "specific_surface").mean.value() == Approx(free / volumes));
  CHECK(find(means, "mean_coordination").mean.value() == Approx(2 * 149 / 150.0));
  CHECK(find(means, "bond_to_grain_ratio").mean.value() == Approx(ratios));
  CHECK(find(means, "solidity_mean").mean.value() == Approx(solidity));
  CHECK(find(means, "corrected_grain_diameter_mean").mean.value() == Approx(weighted / weights));
  CHECK(bootstrapMeans(chain.grains, chain.bonds, {}, 100).size() == 6);
}

TEST_CASE("bootstrap: intervals are those of the normal distribution, of a large sample",
          "[bootstrap]") {
  const Chain chain(400, 9);
  const auto means = bootstrapMeans(chain.grains, chain.bonds, {}, 4000);
  const MeanInterval& diameter = find(means, "grain_diameter_mean");
  double squares = 0;
  for (const GrainMeasures& grain : chain.grains)
    squares += std::pow(grain.equivalentDiameter - diameter.mean.value(), 2);
  const double width = 1.96 * std::sqrt(squares / 400 / 400);
  CHECK(diameter.low.value() == Approx(diameter.mean.value() - width).margin(0.1 * width));
  CHECK(diameter.high.value() == Approx(diameter.mean.value() + width).margin(0.1 * width));
}

TEST_CASE("bootstrap: of few grains, and of none", "[bootstrap]") {
  for (const MeanInterval& mean : bootstrapMeans({}, {}, {}, 100)) {
    CHECK_FALSE(mean.mean);
    CHECK_FALSE(mean.low);
    CHECK_FALSE(mean.high);
  }
  const Chain one(1, 1);
  const auto ofOne = bootstrapMeans(one.grains, one.bonds, {}, 100);
  const MeanInterval& diameter = find(ofOne, "grain_diameter_mean");
  CHECK(diameter.low.value() == diameter.mean.value());
  CHECK(diameter.high.value() == diameter.mean.value());
  CHECK_FALSE(find(ofOne, "bond_to_grain_ratio").mean);
  // The first of two grains has no bond: draws of it alone have no ratio, and do not count.
  Chain two(2, 1);
  two.grains[0].coordination = 0;
  const auto ofTwo = bootstrapMeans(two.grains, {}, {}, 200);
  CHECK(find(ofTwo, "bond_to_grain_ratio").low == 0.0);
  CHECK(find(ofTwo, "mean_coordination").low == 0.0);
  CHECK_THROWS_AS(bootstrapMeans({}, {}, {}, 99), InvalidInput);
  CHECK_THROWS_AS(bootstrapMeans({}, {}, {}, 100001), InvalidInput);
}
