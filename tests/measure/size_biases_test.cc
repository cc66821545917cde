// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/measure/size_biases.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "support/catch.h"
#include "vdb_madf/grids/object_keys.h"

using namespace vdb_madf;

namespace {

/// Grains and bonds of one size each.
Measurements ofSizes(double grainRadius, double bondRadius) {
  Measurements measured;
  measured.grains.resize(3);
  for (GrainMeasures& grain : measured.grains) {
    grain.equivalentDiameter = 2 * grainRadius;
    grain.volume = 4 * M_PI / 3 * std::pow(grainRadius, 3);
  }
  measured.bonds.resize(2);
  for (BondMeasures& bond : measured.bonds) bond.equivalentRadius = bondRadius;
  return measured;
}

std::vector<std::string> numbers(const Measurements& measured) {
  std::vector<std::string> all;
  for (const SizeBias& bias : sizeBiases(measured)) all.push_back(bias.number);
  return all;
}

}  // namespace

TEST_CASE("size_biases: no word of large grains, of none, of slices", "[size_biases]") {
  CHECK(sizeBiases({}).empty());
  CHECK(sizeBiases(ofSizes(40, 12)).empty());
  Measurements small = ofSizes(3, 2);
  CHECK_FALSE(sizeBiases(small).empty());
  small.sample.box = {openvdb::Coord(0), openvdb::Coord(20, 20, 0)};
  CHECK(sizeBiases(small).empty());
}

TEST_CASE("size_biases: of unequal voxels cubes as large as they count", "[size_biases]") {
  Measurements thick = ofSizes(8, 5);
  thick.edges = {1, 1, 8};  // lengths are in the shortest edge
  const auto biases = sizeBiases(thick), ofCubes = sizeBiases(ofSizes(4, 2.5));
  REQUIRE(biases.size() == ofCubes.size());
  CHECK(biases.size() > 1);
  for (size_t i = 0; i < biases.size(); ++i)
    CHECK(biases[i].expected == Approx(ofCubes[i].expected));
}

TEST_CASE("size_biases: each number by its own size, up to where it is enough", "[size_biases]") {
  using Names = std::vector<std::string>;
  CHECK(numbers(ofSizes(2.5, 12)) == Names{"grains", "specific_surface", "mean_coordination"});
  CHECK(numbers(ofSizes(40, 2)) == Names{"bond_area"});
  Measurements alone = ofSizes(40, 2);
  alone.bonds.clear();
  CHECK(sizeBiases(alone).empty());
  for (const SizeBias& bias : sizeBiases(ofSizes(4, 2))) {
    const bool ofBonds = bias.number == "bond_area";
    INFO(toString(bias));
    const auto at = [&](double radius) {
      return ofBonds ? ofSizes(40, radius) : ofSizes(radius, 12);
    };
    const auto says = [&](double radius) {
      const Names all = numbers(at(radius));
      return std::find(all.begin(), all.end(), bias.number) != all.end();
    };
    CHECK(says(bias.enough - 0.2));
    CHECK_FALSE(says(bias.enough + 0.2));
  }
}

TEST_CASE("size_biases: of a gray scan they are larger", "[size_biases]") {
  Measurements measured = ofSizes(4, 2);
  const auto clean = sizeBiases(measured);
  measured.metadata.insertMeta(kThresholdKey, openvdb::DoubleMetadata(7));
  const auto scan = sizeBiases(measured);
  REQUIRE(clean.size() == 3);
  REQUIRE(scan.size() == 3);
  for (size_t i = 0; i < 3; ++i) {
    CHECK(std::abs(scan[i].expected) > std::abs(clean[i].expected));
    CHECK(scan[i].enough > clean[i].enough);
  }
  CHECK(clean[0].expected == Approx(-0.14));
  CHECK(toString(clean[0]).find("specific_surface about -14 % at a median radius of 4.0 voxels "
                                "(within 5 % from 12 on)") == 0);
}

TEST_CASE("size_biases: by the blur that the scan tells, with that of smoothing", "[size_biases]") {
  const auto surface = [](std::optional<double> sigma, const std::string& steps) {
    Measurements measured = ofSizes(8, 12);
    measured.metadata.insertMeta(kThresholdKey, openvdb::DoubleMetadata(7));
    measured.metadata.insertMeta(kObjectKey, openvdb::StringMetadata(steps));
    if (sigma) measured.scan = ScanBlur{1, 0, 0.05, *sigma};
    const auto biases = sizeBiases(measured);
    REQUIRE(!biases.empty());
    REQUIRE(biases[0].number == "specific_surface");
    return biases[0].expected;
  };
  const double unknown = surface({}, "value >= 7");
  const double sharp = surface(0.29, "value >= 7"), wide = surface(1.04, "value >= 7");
  CHECK(sharp == Approx(sizeBiases(ofSizes(8, 12))[0].expected));
  CHECK(unknown == Approx(surface(0.76, "value >= 7")));
  CHECK(surface(0.9, "value >= 7") == Approx((unknown + wide) / 2));
  CHECK(surface(2, "value >= 7") == Approx(wide));
  CHECK(surface(0.1, "value >= 7") == Approx(sharp));
  CHECK(std::abs(wide) > std::abs(unknown));
  CHECK(surface({}, "median 1, smooth 0.5, value >= 7") ==
        Approx(surface(std::hypot(0.76, 0.5), "value >= 7")));
}

TEST_CASE("size_biases: what a scan tells is wrong where its blur hides contacts",
          "[size_biases]") {
  const auto says = [](double sigma, double grains, double bonds, const std::string& number) {
    Measurements measured = ofSizes(grains, bonds);
    measured.scan = ScanBlur{1, 0, 0.05, sigma};
    const auto all = numbers(measured);
    return std::find(all.begin(), all.end(), number) != all.end();
  };
  CHECK_FALSE(says(0.76, 6, 8, "contact_coordination"));
  CHECK(says(1.04, 6, 8, "contact_coordination"));
  CHECK_FALSE(says(1.04, 12, 8, "contact_coordination"));
  CHECK(says(1.04, 12, 2.8, "neck_area"));
  CHECK_FALSE(says(1.04, 12, 5, "neck_area"));
  CHECK(numbers(ofSizes(6, 2.8)) ==
        std::vector<std::string>{"specific_surface", "mean_coordination", "bond_area"});
}
