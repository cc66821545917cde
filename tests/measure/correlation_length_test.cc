// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/measure/correlation_length.h"

#include <array>
#include <cmath>
#include <optional>
#include <string>

#include "support/catch.h"
#include "support/edge_cases.h"
#include "support/random_case.h"
#include "support/random_volume.h"
#include "support/runs.h"
#include "vdb_madf/base/errors.h"

namespace {

using namespace vdb_madf;
using namespace vdb_madf::test;
using Lengths = std::array<std::optional<double>, 3>;

const double kTarget = std::exp(-1.0);

Lengths lengths(const ObjectVolume& object, Tiles tiles = Tiles::none) {
  return correlationLengths(LeafIndex(*toMask(object, tiles)), object.box());
}

/// By the definition, pair by pair. Of a region as of a box.
std::optional<double> naiveLength(const ObjectVolume& object, const ObjectVolume& region,
                                  int axis) {
  const double n = double(countObject(object)), all = double(countObject(region)), f = n / all;
  if (n == 0 || n == all) return std::nullopt;
  double before = 1;
  for (int lag = 1; 2 * lag <= region.box().dim()[axis]; ++lag) {
    double both = 0, pairs = 0;
    for (int i = 0; i < region.size(); ++i) {
      Coord other = region.coord(i);
      other[axis] += lag;
      if (!region[i] || !region.get(other, 0)) continue;
      ++pairs;
      both += object.get(region.coord(i), 0) && object.get(other, 0);
    }
    if (pairs == 0) return std::nullopt;
    const double c = (both / pairs - f * f) / (f - f * f);
    if (c <= kTarget) return lag - 1 + (before - kTarget) / (before - c);
    before = c;
  }
  return std::nullopt;
}

void requireNaive(const Lengths& found, const ObjectVolume& object, const ObjectVolume& region) {
  for (int axis = 0; axis < 3; ++axis) {
    CAPTURE(axis);
    const auto expected = naiveLength(object, region, axis);
    REQUIRE(found[size_t(axis)].has_value() == expected.has_value());
    if (expected) REQUIRE(*found[size_t(axis)] == Approx(*expected));
  }
}
void requireNaive(const Lengths& found, const ObjectVolume& object) {
  requireNaive(found, object, ObjectVolume(object.box(), 1));
}

/// Layers across an axis, `thick` voxels of object and as many of background in turn.
ObjectVolume layers(const CoordBBox& box, int axis, int thick) {
  ObjectVolume object(box);
  for (int i = 0; i < object.size(); ++i)
    object[i] = (object.coord(i) - box.min())[axis] / thick % 2 == 0;
  return object;
}

}  // namespace

TEST_CASE("correlation_length: drawn by hand", "[correlation_length]") {
  // Half of eight: f = 1/2, S(r) = (4 - r)/(8 - r). (S - f^2)/(f - f^2) is 5/7 at 1, 1/3 at 2.
  const double halved = 1 + (5.0 / 7 - kTarget) / (5.0 / 7 - 1.0 / 3);
  CHECK(lengths(fromPicture("####...."))[2].value() == Approx(halved));
  CHECK(lengths(fromPicture("#|#|#|#|.|.|.|."))[0].value() == Approx(halved));
  CHECK(lengths(fromPicture("##/##/##/##/../../../.."))[1].value() == Approx(halved));
  // Along a layer nothing changes.
  CHECK_FALSE(lengths(fromPicture("##/##/##/##/../../../.."))[2].has_value());
  // In turn: S(1) = 0, the correlation -1.
  CHECK(lengths(fromPicture("#.#.#.#."))[2].value() == Approx((1 - kTarget) / 2));
  // One of n: S(1) = 0, the correlation -f/(1 - f).
  CHECK(lengths(fromPicture("...#./....."))[2].value() == Approx((1 - kTarget) * 9 / 10));
}

TEST_CASE("correlation_length: none without two phases, or within half the box",
          "[correlation_length]") {
  const Lengths none{};
  CHECK(lengths(ObjectVolume(boxAt({-3, 5, 6}, Coord(9)))) == none);
  for (const Tiles tiles : {Tiles::none, Tiles::wherePossible})
    CHECK(lengths(ObjectVolume(boxAt({-8, 0, 8}, {16, 8, 24}), 1), tiles) == none);
  CHECK(lengths(fromPicture("#./##")) != none);
  CHECK_FALSE(lengths(fromPicture("#/."))[2].has_value());  // no pairs along z
  // Lags up to half the box, that one included: two voxels and three have the lag 1.
  CHECK(lengths(fromPicture("#.")).at(2).has_value());
  CHECK(lengths(fromPicture("#.#")).at(2).has_value());
  // (4/5, 3/4, 2/3 - 25/36) / (5/36) = 0.76, 0.4, -0.2: falls at the last lag there is.
  CHECK(lengths(fromPicture("#####."))[2].value() == Approx(2 + (0.4 - kTarget) / 0.6));
  // f = 7/12, S = 5/9, 3/6, 1/3: 31/35 and 23/35 at the two lags there are, -1/35 at the next.
  CHECK_FALSE(lengths(fromPicture("####/..../###."))[2].has_value());
}

TEST_CASE("correlation_length: of edge cases", "[correlation_length]") {
  for (const EdgeCase& c : edgeCases()) {
    if (c.object.size() == 0) continue;  // no box
    INFO(c.name);
    requireNaive(lengths(c.object, c.tiles), c.object);
    CoordBBox wider = c.object.box();  // background all around
    wider.expand(5);
    const ObjectVolume padded = withBox(c.object, wider);
    requireNaive(lengths(padded, c.tiles), padded);
  }
}

TEST_CASE("correlation_length: by the definition on random volumes", "[correlation_length]") {
  for (uint64_t seed = 1; seed <= 190; ++seed) {
    Rng rng(seed);
    const auto kind = VolumeKind(int(seed) % kVolumeKinds);
    const Coord size(rng.between(1, 26), rng.between(1, 26), rng.between(1, 26));
    const ObjectVolume object = randomVolume(kind, boxAt(randomOrigin(rng), size), rng);
    INFO("seed " << seed << ", " << name(kind) << ", " << toString(object.box()));
    requireNaive(lengths(object, seed % 2 ? Tiles::wherePossible : Tiles::none), object);
  }
}

TEST_CASE("correlation_length: in a region only its pairs count", "[correlation_length]") {
  int regions = 0, lengthsFound = 0;
  for (uint64_t seed = 1; seed <= 250; ++seed) {
    RandomCase c = randomCase(seed);
    if (!c.domain) c.domain = c.object.box();
    drawRegion(c);
    if (!c.region) continue;
    INFO(describe(c));
    const Domain domain = *domainOf(c);
    const LeafIndex index(*toMask(c.object));
    const Lengths found = withThreads(c.threads, [&] { return correlationLengths(index, domain); });
    requireNaive(found, c.object, *c.region);
    regions += !domain.isBox();
    for (const auto& length : found) lengthsFound += length.has_value();
  }
  CHECK(regions > 120);
  CHECK(lengthsFound > 120);
}

TEST_CASE("correlation_length: in a region of many tiles and leaves", "[correlation_length]") {
  // A box of tiles with ragged ends and two gaps, one of them a whole leaf; layers of object across
  // each axis in turn.
  for (int axis = 0; axis < 3; ++axis) {
    CAPTURE(axis);
    Coord dim(35);
    dim[axis] = 330;
    const CoordBBox box = boxAt(Coord(-5, -131, 120), dim);
    ObjectVolume region(box, 1), object = layers(box, axis, 23);
    for (int i = 0; i < region.size(); ++i) {
      const Coord d = region.coord(i) - box.min();
      const int along = d[axis], across = d[(axis + 1) % 3];
      const bool inLeaf = region.coord(i)[axis] >> 3 == 20;
      if (inLeaf || std::abs(along - 110) < 9 || along < across % 7) region[i] = object[i] = 0;
    }
    const Domain domain(toMask(region, Tiles::wherePossible)->tree());
    REQUIRE(domain.region()->activeTileCount() > 100);
    const Lengths found = correlationLengths(LeafIndex(*toMask(object)), domain);
    CHECK(found[size_t(axis)].has_value());
    requireNaive(found, object, region);
  }
}

TEST_CASE("correlation_length: none between parts of a region that have no pairs",
          "[correlation_length]") {
  // Two pairs of voxels, ten apart: f = 3/4, S(1) = 1/2, (1/2 - 9/16) / (3/16) = -1/3.
  ObjectVolume region = fromPicture("##..........##"), object = fromPicture("##..........#.");
  const auto length = [&] {
    return correlationLengths(LeafIndex(*toMask(object)), Domain(toMask(region)->tree()))[2];
  };
  CHECK(length().value() == Approx((1 - kTarget) * 3 / 4));
  // Single voxels, with no pair at lag 1.
  region = fromPicture("#..#..#"), object = fromPicture("#..#...");
  CHECK_FALSE(length().has_value());
}

TEST_CASE("correlation_length: beyond many leaves, empty ones between", "[correlation_length]") {
  // Layers of n, n apart, in a long box: S(r) = 1/2 - r/(2n) + ..., the correlation 1 - 2r/n.
  for (int axis = 0; axis < 3; ++axis)
    for (const int thick : {20, 70, 97}) {
      Coord dim(3);
      dim[axis] = 40 * thick;
      const ObjectVolume object = layers(boxAt(Coord(-7, 3, -50), dim), axis, thick);
      CAPTURE(axis, thick);
      const Lengths found = lengths(object);
      requireNaive(found, object);
      CHECK(found[size_t(axis)].value() == Approx((1 - kTarget) / 2 * thick).epsilon(0.02));
      CHECK_FALSE(found[size_t((axis + 1) % 3)].has_value());
    }
}

TEST_CASE("correlation_length: moved it stays, turned it turns", "[correlation_length]") {
  for (uint64_t seed = 1; seed <= 5; ++seed) {
    CAPTURE(seed);
    Rng rng(seed);
    const ObjectVolume object =
        randomVolume(VolumeKind::blurredNoise, boxAt({-6, 1, 40}, {17, 22, 27}), rng);
    const Lengths expected = lengths(object);
    for (int step = 1; step <= 8; ++step)
      REQUIRE(lengths(translated(object, Coord(step, -step, 3 * step))) == expected);
    const AxisMap map{{2, 0, 1}, {rng.chance(0.5), rng.chance(0.5), rng.chance(0.5)}};
    const Lengths turned = lengths(permuted(object, map));
    for (size_t axis = 0; axis < 3; ++axis)
      REQUIRE(turned[axis] == expected[size_t(map.from[axis])]);
  }
}

TEST_CASE("correlation_length: threads do not matter", "[correlation_length]") {
  Rng rng(8);  // more leaves than one task takes
  const ObjectVolume object =
      randomVolume(VolumeKind::blurredNoise, boxAt({-1, -150, 3}, {2, 300, 310}), rng);
  const LeafIndex index(*toMask(object));
  REQUIRE(index.leafCount() > 2048);
  const auto run = [&] { return correlationLengths(index, object.box()); };
  const Lengths expected = withThreads(1, run);
  CHECK(expected[1].has_value());
  for (const int threads : {2, 4, 4}) CHECK(withThreads(threads, run) == expected);
  requireNaive(expected, object);
}

TEST_CASE("correlation_length: none once interrupted", "[correlation_length]") {
  const ObjectVolume object = fromPicture("##..");
  const LeafIndex index(*toMask(object));
  StopAtOnce stop;
  CHECK_THROWS_AS(correlationLengths(index, object.box(), &stop), Interrupted);
}
