// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/samples/bed.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "support/balls.h"
#include "support/catch.h"
#include "support/samples.h"
#include "vdb_madf/samples/detail/placement.h"

namespace {

using namespace vdb_madf;
using namespace vdb_madf::test;

BedOptions smallBed() {
  BedOptions options;
  options.size = {52, 47, 55};
  options.minRadius = 7;
  options.maxRadius = 11;
  options.rounds = 2;
  options.seed = 6;
  return options;
}

Sample bedAfter(int rounds, BedOptions options = smallBed()) {
  options.rounds = rounds;
  return generateBed(options);
}

double distance(const detail::Ball& a, const detail::Ball& b) {
  return std::sqrt((a.x - b.x) * (a.x - b.x) + (a.y - b.y) * (a.y - b.y) +
                   (a.z - b.z) * (a.z - b.z));
}

/// The indicator of a sample, beyond the faces as at the faces, blurred at a voxel.
double blurredAt(const Sample& sample, const Coord& p) {
  const CoordBBox domain = storedDomain(*sample.object)->box();
  double sum = 0, weights = 0;
  for (auto k = CoordBBox(Coord(-8), Coord(8)).begin(); k; ++k) {
    const Coord d = *k,
                q = Coord::minComponent(Coord::maxComponent(p + d, domain.min()), domain.max());
    const double weight = std::exp(-(d.x() * d.x() + d.y() * d.y() + d.z() * d.z()) / 8.0);
    weights += weight;
    if (sample.object->tree().isValueOn(q)) sum += weight;
  }
  return sum / weights;
}

}  // namespace

// Whoever compares methods on these samples relies on a seed giving the same sample for ever.
TEST_CASE("bed: the bits are fixed", "[bed]") {
  CHECK(hash(generateBed(smallBed())) == 0x4a798a0f9267e8b8u);
}

TEST_CASE("bed: seeds differ, threads do not matter", "[bed]") {
  requireSeedsDiffer([](uint64_t seed) {
    auto options = smallBed();
    options.seed = seed;
    return generateBed(options);
  });
  auto options = smallBed();
  options.size = {140, 40, 30};  // several blocks
  requireSameForAnyThreads([&] { return generateBed(options); });
}

TEST_CASE("bed: no voxel lies outside the box", "[bed]") {
  requireInsideDomain(generateBed(smallBed()));
}

TEST_CASE("bed: each ball lies on the floor or on one below, and no two are closer", "[bed]") {
  BedOptions options = smallBed();
  for (options.seed = 1; options.seed <= 4; ++options.seed) {
    const auto balls = detail::dropBalls(options, nullptr);
    REQUIRE(balls.size() > 10);
    for (size_t i = 0; i < balls.size(); ++i) {
      double support = (balls[i].z - balls[i].radius + 0.5) / balls[i].radius;
      for (size_t j = 0; j < i; ++j) {
        const double contact = 0.97 * (balls[i].radius + balls[j].radius);
        const double apart = distance(balls[i], balls[j]) / contact;
        CHECK(apart > 1 - 1e-9);
        if (balls[j].z < balls[i].z) support = std::min(support, apart - 1);
      }
      CHECK(std::abs(support) < 1e-9);
      CHECK(balls[i].z - balls[i].radius <= options.size.z() - 0.5);
    }
  }
}

TEST_CASE("bed: before sintering, truth is the power cells of the balls", "[bed]") {
  auto balls = detail::dropBalls(smallBed(), nullptr);
  detail::sortByCenter(balls);
  requireTruth(bedAfter(0), balls);
}

TEST_CASE("bed: a round cuts the blurred object at one level, which keeps the volume", "[bed]") {
  const Sample before = bedAfter(1), after = bedAfter(2);
  const auto voxels = double(before.object->activeVoxelCount());
  CHECK(double(after.object->activeVoxelCount()) <= voxels);
  CHECK(double(after.object->activeVoxelCount()) > 0.999 * voxels);
  std::mt19937 random(1);
  double lowestIn = 1, highestOut = 0;
  for (int i = 0; i < 2000; ++i) {
    const Coord p(int(random() % 52), int(random() % 47), int(random() % 55));
    const double value = blurredAt(before, p);
    if (after.object->tree().isValueOn(p))
      lowestIn = std::min(lowestIn, value);
    else
      highestOut = std::max(highestOut, value);
  }
  CHECK(highestOut < lowestIn + 1e-5);
}

TEST_CASE("bed: a voxel takes the label of the nearest one of the round before", "[bed]") {
  const Sample before = bedAfter(0), after = bedAfter(1);
  CHECK(after.truth->tree().hasSameTopology(after.object->tree()));
  int64_t wrong = 0, grown = 0;
  for (auto voxel = after.truth->cbeginValueOn(); voxel; ++voxel) {
    const Coord p = voxel.getCoord();
    int least = 1000;
    std::set<int32_t> nearest;
    for (auto k = CoordBBox(Coord(-3), Coord(3)).begin(); k; ++k) {
      const Coord d = *k;
      const int square = d.x() * d.x() + d.y() * d.y() + d.z() * d.z();
      const int32_t label = before.truth->tree().getValue(p + d);
      if (label == 0 || square > least) continue;
      if (square < least) nearest.clear();
      least = square;
      nearest.insert(label);
    }
    if (least > 9) continue;  // a nearer one may lie beyond the cube
    grown += least > 0;
    wrong += *voxel != *nearest.begin();
  }
  CHECK(grown > 100);
  CHECK(wrong == 0);
}

TEST_CASE("bed: necks grow", "[bed]") {
  // Of voxels with another grain beside them there are more after sintering.
  const auto contacts = [](const Sample& sample) {
    int64_t count = 0;
    const auto& tree = sample.truth->tree();
    for (auto voxel = sample.truth->cbeginValueOn(); voxel; ++voxel) {
      const int32_t right = tree.getValue(voxel.getCoord().offsetBy(1, 0, 0));
      count += right != 0 && right != *voxel;
    }
    return count;
  };
  CHECK(contacts(bedAfter(6)) > contacts(bedAfter(0)) * 5 / 4);
}

TEST_CASE("bed: one voxel", "[bed]") {
  BedOptions options = smallBed();
  options.size = Coord(1);
  const Sample sample = generateBed(options);
  CHECK(sample.truth->activeVoxelCount() == sample.object->activeVoxelCount());
}

TEST_CASE("bed: bad options are refused", "[bed]") {
  const auto refuses = [](auto change) {
    BedOptions options = smallBed();
    change(options);
    CHECK_THROWS_AS(generateBed(options), InvalidInput);
  };
  refuses([](auto& o) { o.size = {0, 1, 1}; });
  refuses([](auto& o) { o.minRadius = 0; });
  refuses([](auto& o) { o.maxRadius = 6; });
  refuses([](auto& o) { o.rounds = -1; });
  refuses([](auto& o) { o.rounds = 1001; });
}

TEST_CASE("bed: stops when asked to", "[bed]") {
  requireStops([](Interrupter* stop) { return generateBed(smallBed(), stop); });
}
