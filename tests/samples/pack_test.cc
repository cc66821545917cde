// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/samples/pack.h"

#include <cmath>
#include <limits>

#include "support/catch.h"
#include "support/samples.h"

namespace {

using namespace vdb_madf;
using namespace vdb_madf::test;

PackOptions smallPack() {
  PackOptions options;
  options.size = {70, 64, 57};
  options.minRadius = 2;
  options.maxRadius = 6;
  options.seed = 4;
  return options;
}

}  // namespace

// Whoever compares methods on these samples relies on a seed giving the same sample for ever.
TEST_CASE("pack: the bits are fixed", "[pack]") {
  CHECK(hash(generatePack(smallPack())) == 0x1cd81e19a1586587u);
}

TEST_CASE("pack: seeds differ, threads do not matter", "[pack]") {
  requireSeedsDiffer([](uint64_t seed) {
    auto options = smallPack();
    options.seed = seed;
    return generatePack(options);
  });
  auto options = smallPack();
  options.size = {140, 60, 135};  // several blocks
  requireSameForAnyThreads([&] { return generatePack(options); });
}

TEST_CASE("pack: no voxel lies outside the box", "[pack]") {
  const Sample sample = generatePack(smallPack());
  requireInsideDomain(sample);
  CHECK(!sample.truth);
}

TEST_CASE("pack: meets its fraction", "[pack]") {
  for (const double fraction : {0.01, 0.25, 0.6, 0.97}) {
    CAPTURE(fraction);
    PackOptions options = smallPack();
    options.fraction = fraction;
    CHECK(std::abs(solidFraction(generatePack(options)) - fraction) <= 0.005);
    options.size = Coord(40);
    options.minRadius = 8;
    options.maxRadius = 28;
    if (fraction < 0.9) CHECK(std::abs(solidFraction(generatePack(options)) - fraction) <= 0.005);
  }
}

TEST_CASE("pack: is as dense at the faces as within", "[pack]") {
  PackOptions options;
  options.size = Coord(200);
  options.minRadius = 3;
  options.maxRadius = 8;
  const Sample sample = generatePack(options);
  int64_t face = 0;
  for (auto p = CoordBBox({0, 0, 0}, {3, 199, 199}).begin(); p; ++p)
    face += sample.object->tree().isValueOn(*p);
  CHECK(double(face) / (4 * 200 * 200) == Approx(0.25).margin(0.03));
  CHECK(sample.object->tree().activeTileCount() > 0);
}

TEST_CASE("pack: one voxel and thin boxes", "[pack]") {
  PackOptions pack;
  pack.size = {300, 1, 300};
  CHECK(std::abs(solidFraction(generatePack(pack)) - 0.25) <= 0.005);
  pack.size = Coord(1);
  CHECK_THROWS_AS(generatePack(pack), InvalidInput);
}

TEST_CASE("pack: in slabs it is the same", "[pack]") {
  for (const bool unequal : {false, true}) {
    PackOptions options;
    options.size = {60, 50, 300};
    options.minRadius = 3;
    options.maxRadius = 9;
    options.fraction = 0.4;
    if (unequal) options.voxelSize = VoxelSize({1e-6, 1e-6, 2e-6});
    const Sample whole = generatePack(options);
    const PackSlabs slabs(options);
    CHECK(slabs.objectVoxels() == int64_t(whole.object->activeVoxelCount()));
    REQUIRE(slabs.cuts() ==
            (unequal ? std::vector<int>{0, 128, 152} : std::vector<int>{0, 128, 256, 304}));
    Sample joined;
    for (size_t s = 0; s < slabs.slabCount(); ++s) {
      const MaskGrid::Ptr slab = slabs.object(s);
      const CoordBBox box = slab->evalActiveVoxelBoundingBox();
      CHECK(box.min().z() >= slabs.cuts()[s]);
      CHECK(box.max().z() < slabs.cuts()[s + 1]);
      CHECK(storedDomain(*slab) == storedDomain(*whole.object));
      if (s == 0)
        joined.object = slab;
      else
        joined.object->tree().merge(slab->tree());
    }
    CHECK(hash(joined) == hash(whole));
  }
  PackOptions tall;
  tall.size = {3, 2, 30000};
  tall.minRadius = tall.maxRadius = 40;
  CHECK(PackSlabs(tall).cuts().back() == 30000);
  tall.size.z() = (1 << 20) + 1;
  CHECK_THROWS_AS(PackSlabs(tall), InvalidInput);
}

TEST_CASE("pack: batches of balls in slabs", "[pack]") {
  PackOptions options;  // so many balls that they come in batches first
  options.size = {90, 80, 260};
  options.minRadius = 1;
  options.maxRadius = 2.5;
  Sample joined;
  joined.object = PackSlabs(options).object(0);
  for (size_t s = 1; s < 3; ++s) joined.object->tree().merge(PackSlabs(options).object(s)->tree());
  CHECK(hash(joined) == hash(generatePack(options)));
}

TEST_CASE("pack: bad options are refused", "[pack]") {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto refuses = [](auto change) {
    PackOptions options = smallPack();
    change(options);
    CHECK_THROWS_AS(generatePack(options), InvalidInput);
  };
  refuses([](auto& o) { o.size = {10, -1, 10}; });
  refuses([](auto& o) { o.fraction = 0; });
  refuses([](auto& o) { o.fraction = 1; });
  refuses([&](auto& o) { o.fraction = nan; });
  refuses([](auto& o) { o.minRadius = 0.1; });
  refuses([](auto& o) { o.maxRadius = 1e9; });
}

TEST_CASE("pack: stops when asked to", "[pack]") {
  requireStops([](Interrupter* stop) { return generatePack(smallPack(), stop); });
}
