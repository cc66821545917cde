// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

// segment() against the brute-force oracle, and what it refuses.
//
// The random comparison reads from the environment VDB_MADF_CASES (how many), VDB_MADF_SEED (the
// first) and VDB_MADF_SIDE (longest side of every volume; by default 32, some 48).

#include "vdb_madf/segmentation/segment.h"
#include "vdb_madf/base/limits.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <sstream>
#include <tuple>

#include "support/catch.h"
#include "support/invariants.h"
#include "support/oracle.h"
#include "support/random_case.h"
#include "support/runs.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/grids/grid_metadata.h"

namespace {

using namespace vdb_madf;
using namespace vdb_madf::test;

std::string difference(const ManifoldGraph& graph, const ManifoldGraph& expected) {
  std::ostringstream text;
  for (size_t i = 0; i < std::min(graph.nodes.size(), expected.nodes.size()); ++i) {
    const auto &a = graph.nodes[i], &b = expected.nodes[i];
    if (a == b) continue;
    text << "node " << i << ": " << a.position << " D " << a.squaredRadius << ", " << a.voxels
         << " voxels; expected " << b.position << " D " << b.squaredRadius << ", " << b.voxels;
    return text.str();
  }
  for (size_t i = 0; i < std::min(graph.edges.size(), expected.edges.size()); ++i) {
    const auto &a = graph.edges[i], &b = expected.edges[i];
    if (a == b) continue;
    text << "edge " << i;
    for (const auto& edge : {a, b})
      text << ": " << edge.first << "-" << edge.second << " faces " << edge.contactFaces << " h "
           << edge.saddleHeight << " cells " << edge.cellsTouch << (&edge == &a ? "" : "; ");
    return text.str();
  }
  if (graph.nodes.size() != expected.nodes.size() || graph.edges.size() != expected.edges.size())
    text << graph.nodes.size() << " nodes and " << graph.edges.size() << " edges, expected "
         << expected.nodes.size() << " and " << expected.edges.size();
  return text.str();
}

std::string difference(const std::vector<MedialBall>& balls,
                       const std::vector<MedialBall>& expected) {
  std::ostringstream text;
  for (size_t i = 0; i < std::min(balls.size(), expected.size()); ++i) {
    const auto &a = balls[i], &b = expected[i];
    if (std::tie(a.center, a.squaredRadius, a.cellSize) ==
        std::tie(b.center, b.squaredRadius, b.cellSize))
      continue;
    text << "ball " << i << ": " << a.center << " D " << a.squaredRadius << " cell " << a.cellSize
         << ", expected " << b.center << " D " << b.squaredRadius << " cell " << b.cellSize;
    return text.str();
  }
  if (balls.size() != expected.size())
    text << balls.size() << " balls, expected " << expected.size();
  return text.str();
}

std::string difference(const SegmentCounts& a, const SegmentCounts& b) {
  std::ostringstream text;
  const auto check = [&](const char* what, int64_t value, int64_t expected) {
    if (value != expected) text << what << " " << value << ", expected " << expected << "; ";
  };
  check("object voxels", a.objectVoxels, b.objectVoxels);
  check("cavities", a.cavities, b.cavities);
  check("voxels in cavities", a.cavityVoxels, b.cavityVoxels);
  check("medial balls", a.medialBalls, b.medialBalls);
  check("kept balls", a.keptBalls, b.keptBalls);
  check("critical points", a.criticalPoints, b.criticalPoints);
  check("grains", a.grains, b.grains);
  check("largest squared distance", a.largestSquaredDistance, b.largestSquaredDistance);
  check("leaves", a.leaves, b.leaves);
  return text.str();
}

std::string difference(const LabelFlaws& a, const LabelFlaws& b) {
  std::ostringstream text;
  const auto check = [&](const char* what, int64_t value, int64_t expected) {
    if (value != expected) text << what << " " << value << ", expected " << expected << "; ";
  };
  check("crumbs", a.crumbs, b.crumbs);
  check("specks", a.specks, b.specks);
  check("slivers", a.slivers, b.slivers);
  check("grains in pieces", a.inPieces, b.inPieces);
  return text.str();
}

std::string sizesDifference(const Segmentation& s, const DenseVolume<int64_t>& grain) {
  std::vector<int64_t> voxels(size_t(s.counts.grains), 0);
  for (int i = 0; i < grain.size(); ++i)
    if (grain[i]) ++voxels[size_t(grain[i] - 1)];
  return voxels == s.grainVoxels ? "" : "the sizes of grains are others";
}

/// Everything that the library says otherwise than the oracle, and every broken invariant.
std::string disagreement(const RandomCase& c) {
  std::optional<OracleResult> expected;
  std::string undefined;
  try {
    expected = oracleSegment(c.object, oracleDomainOf(c), c.options);
  } catch (const Undefined& e) {
    undefined = e.what();
  }
  const auto mask = maskOf(c);
  Segmentation result;
  try {
    result = withThreads(c.threads, [&] { return segment(*mask, optionsOf(c)); });
  } catch (const InvalidInput& e) {
    return expected ? std::string("refused: ") + e.what() : "";
  }
  if (!expected) return "accepted, though " + undefined;

  std::ostringstream all;
  const auto add = [&](const std::string& text) {
    if (!text.empty()) all << text << '\n';
  };
  add(difference(result.counts, expected->counts));
  add(difference(result.flaws, expected->flaws));
  if (result.counts.grains == expected->counts.grains)
    add(sizesDifference(result, expected->grain));
  const std::pair<const char*, std::pair<const Int32Grid*, const DenseVolume<int64_t>*>> grids[] = {
      {"distance_squared", {result.distanceSquared.get(), &expected->distance}},
      {"power", {result.power.get(), &expected->filtered.power}},
      {"manifold", {result.manifold.get(), &expected->manifold}},
      {"grain", {result.grain.get(), &expected->grain}}};
  for (const auto& [what, pair] : grids)
    add(pair.first ? difference(what, *pair.first, c.object, *pair.second)
                   : std::string("no grid ") + what);
  add(difference(result.balls, expected->balls));
  add(difference(result.graph, expected->graph));
  if (result.open != expected->open) add("the other boundary");
  if (result.domain != domainOf(c)) add("another domain");
  if (result.weights != c.options.weights.value_or(VoxelWeights{})) add("other weights");
  if (all.str().empty()) add(anyViolation(result, *mask, c.options.gamma));
  return all.str();
}

void requireAgreement(const RandomCase& c) {
  if (disagreement(c).empty()) return;
  const RandomCase small = shrink(c, [](const RandomCase& d) { return !disagreement(d).empty(); });
  FAIL(describe(c) << "shrunk to " << describe(small) << disagreement(small));
}

}  // namespace

TEST_CASE("segment: agrees with the oracle on random volumes", "[segment]") {
  const uint64_t first = fromEnvironment("VDB_MADF_SEED", 1);
  const uint64_t cases = fromEnvironment("VDB_MADF_CASES", 10 * kCombinations);
  const int side = int(fromEnvironment("VDB_MADF_SIDE", 0));
  constexpr uint64_t kLargeEvery = 211;  // a prime: all combinations get large volumes in the end
  std::map<std::tuple<Boundary, Adjacency, MergeMode, int>, int> seen;
  std::map<VolumeKind, int> kinds;
  for (uint64_t seed = first; seed < first + cases; ++seed) {
    std::optional<Coord> size;
    Rng rng(~seed);
    if (side > 0)
      size = Coord(rng.between(1, side), rng.between(1, side), rng.between(1, side));
    else if (seed % kLargeEvery == 0)
      size = Coord(48);
    const RandomCase c = randomCase(seed, size);
    requireAgreement(c);
    const MergeOptions& merge = c.options.merge;
    ++seen[{c.options.boundary, merge.adjacency, merge.mode, c.threads}];
    ++kinds[c.kind];
  }
  if (cases < 3 * uint64_t(kCombinations)) return;
  CHECK(int(seen.size()) == kCombinations);
  for (const auto& entry : seen) CHECK(entry.second >= 3);
  CHECK(int(kinds.size()) == kVolumeKinds);
}

TEST_CASE("segment: agrees with the oracle in random regions", "[segment]") {
  const uint64_t first = fromEnvironment("VDB_MADF_SEED", 1);
  const uint64_t cases = fromEnvironment("VDB_MADF_CASES", 8 * kCombinations);
  uint64_t regions = 0, open = 0;
  for (uint64_t seed = first; seed < first + cases; ++seed) {
    Rng rng(seed + 5000);
    std::optional<Coord> size;
    if (seed % 7 == 0) {  // longer than sweeps reach at first
      size = Coord(rng.between(1, 4));
      (*size)[rng.below(3)] = rng.between(30, 160);
    }
    RandomCase c = randomCase(seed + 100000, size);
    if (!c.domain) c.domain = c.object.box();
    drawRegion(c);
    requireAgreement(c);
    regions += c.region.has_value();
    open += c.region && c.options.boundary != Boundary::closed;
  }
  if (cases < 3 * uint64_t(kCombinations)) return;
  CHECK(regions > cases * 3 / 4);
  CHECK(open > cases / 2);
}

TEST_CASE("segment: agrees with the oracle on every kind of small volume", "[segment]") {
  for (int kind = 0; kind < kVolumeKinds; ++kind)
    for (uint64_t seed = 0; seed < uint64_t(kCombinations); ++seed) {
      RandomCase c = randomCase(seed + 1000, Coord(1));
      Rng rng(seed * uint64_t(kVolumeKinds) + uint64_t(kind));
      c.kind = VolumeKind(kind);
      const Coord size(rng.between(1, 9), rng.between(1, 9), rng.between(1, 9));
      c.object = randomVolume(c.kind, boxAt(randomOrigin(rng), size), rng);
      if (c.domain) c.domain = randomDomain(c.object, rng);
      c.domainInMetadata = c.domainInMetadata && c.domain;
      requireAgreement(c);
    }
}

TEST_CASE("segment: a failure shrinks to its cause", "[segment]") {
  // Two voxels in a row along y, anywhere in the object, count as a failure.
  const auto fails = [](const RandomCase& c) {
    for (int i = 0; i < c.object.size(); ++i)
      if (c.object[i] && c.object.get(c.object.coord(i) + Coord(0, 1, 0), 0)) return true;
    return false;
  };
  RandomCase c = randomCase(5);
  Rng rng(5);
  c.object = randomVolume(VolumeKind::denseNoise, boxAt({-7, 100, 3}, {9, 8, 10}), rng);
  REQUIRE(fails(c));
  const RandomCase small = shrink(c, fails);
  CHECK(small.object == fromPicture("#/#"));
  CHECK(small.threads == 1);
  CHECK(describe(small).find("#\n#\n") != std::string::npos);
}

TEST_CASE("segment: the comparison sees a changed option", "[segment]") {
  // Three equal balls on a rod: theta decides between one grain and three.
  const std::string slice = "#####/#####/#####";
  RandomCase c;
  c.object = fromPicture(slice + "|" + slice + "|" + slice);
  c.options.merge.mode = MergeMode::angle;
  c.options.merge.theta = -0.8;
  const OracleResult expected = oracleSegment(c.object, oracleDomainOf(c), c.options);
  c.options.merge.theta = -0.9;
  const Segmentation other = segment(*maskOf(c), optionsOf(c));
  CHECK_FALSE(difference("grain", *other.grain, c.object, expected.grain).empty());
  CHECK_FALSE(difference(other.counts, expected.counts).empty());
  c.options.gamma = 10;
  const Segmentation filtered = segment(*maskOf(c), optionsOf(c));
  CHECK_FALSE(difference("power", *filtered.power, c.object, expected.filtered.power).empty());
  CHECK_FALSE(difference(filtered.graph, expected.graph).empty());
  c.object[0] = 0;
  const Segmentation less = segment(*maskOf(c), optionsOf(c));
  CHECK_FALSE(difference(less.balls, expected.balls).empty());
}

TEST_CASE("segment: an empty object gives an empty grid", "[segment]") {
  SegmentOptions options;
  options.keepDistance = options.keepPower = options.keepManifold = options.keepBalls = true;
  for (const Boundary boundary : {Boundary::automatic, Boundary::open, Boundary::closed}) {
    options.boundary = boundary;
    options.domain = boxAt({0, 0, 0}, {4, 5, 6});
    const Segmentation result = segment(*MaskGrid::create(), options);
    CHECK(result.counts.grains == 0);
    CHECK(result.counts.objectVoxels == 0);
    CHECK(result.graph.nodes.empty());
    REQUIRE(result.grain);
    for (const auto& grid : {result.grain, result.distanceSquared, result.power, result.manifold}) {
      REQUIRE(grid);
      CHECK(grid->empty());
      CHECK(grid->background() == 0);
    }
  }
}

TEST_CASE("segment: returns the grids that were asked for", "[segment]") {
  const auto mask = toMask(fromPicture("###"));
  setDomain(*mask, boxAt({0, 0, -1}, {1, 1, 9}));
  setVoxelSize(*mask, VoxelSize{5e-6});
  for (int which = 0; which < 16; ++which) {
    SegmentOptions options;
    options.keepDistance = which & 1;
    options.keepPower = which & 2;
    options.keepManifold = which & 4;
    options.keepBalls = which & 8;
    const Segmentation result = segment(*mask, options);
    CHECK(bool(result.distanceSquared) == options.keepDistance);
    CHECK(bool(result.power) == options.keepPower);
    CHECK(bool(result.manifold) == options.keepManifold);
    CHECK(result.balls.empty() != options.keepBalls);
    for (const auto& grid : {result.grain, result.distanceSquared, result.power, result.manifold}) {
      if (!grid) continue;
      CHECK_FALSE(grid->getName().empty());
      CHECK(storedDomain(*grid) == storedDomain(*mask));
      REQUIRE(storedVoxelSize(*grid));
      CHECK(grid->transform() == mask->transform());
    }
    CHECK_FALSE(result.times.empty());
  }
}

TEST_CASE("segment: options out of range are refused", "[segment]") {
  const auto mask = toMask(fromPicture("##"));
  SegmentOptions options;
  SECTION("theta") {
    const double inf = std::numeric_limits<double>::infinity();
    for (const double theta : {std::nan(""), inf, -inf, std::nextafter(1.0, 2.0), -1.000001, 2.0}) {
      options.merge.theta = theta;
      CHECK_THROWS_AS(segment(*mask, options), InvalidInput);
      CHECK_THROWS_AS(segment(*MaskGrid::create(), options), InvalidInput);
    }
    for (const double theta : {-1.0, 1.0}) {
      options.merge.theta = theta;
      CHECK_NOTHROW(segment(*mask, options));
    }
  }
  SECTION("gamma") {
    for (const int64_t gamma : {int64_t(-1), std::numeric_limits<int64_t>::min()}) {
      options.gamma = gamma;
      CHECK_THROWS_AS(segment(*mask, options), InvalidInput);
    }
    // Larger than 32 bits: no cell is that large, each component keeps its best ball.
    for (const int64_t gamma : {int64_t(1) << 32, std::numeric_limits<int64_t>::max()}) {
      options.gamma = gamma;
      CHECK(segment(*mask, options).counts.keptBalls == 1);
    }
  }
  SECTION("a strictness to be found for tests") {
    options.autoStrictness = true;
    CHECK_NOTHROW(segment(*mask, options));
    options.merge.mode = MergeMode::both;
    CHECK_THROWS_AS(segment(*mask, options), InvalidInput);
  }
  SECTION("an open boundary without a domain") {
    options.boundary = Boundary::open;
    CHECK_THROWS_AS(segment(*mask, options), InvalidInput);
  }
}

TEST_CASE("segment: an object outside its domain is refused", "[segment]") {
  const ObjectVolume object = fromPicture("###/###|###/###", {-1, -1, -1});
  for (const Boundary boundary : {Boundary::automatic, Boundary::open, Boundary::closed})
    for (int axis = 0; axis < 3; ++axis)
      for (const int side : {-1, 1}) {
        SegmentOptions options;
        options.boundary = boundary;
        CoordBBox box = object.box();
        box.expand(3);
        options.domain = box;
        CHECK_NOTHROW(segment(*toMask(object), options));
        (side < 0 ? box.min() : box.max())[axis] =
            side < 0 ? object.box().min()[axis] + 1 : object.box().max()[axis] - 1;
        options.domain = box;
        CHECK_THROWS_AS(segment(*toMask(object), options), InvalidInput);
        options.domain.reset();
        const auto mask = toMask(object);
        setDomain(*mask, box);
        CHECK_THROWS_AS(segment(*mask, options), InvalidInput);
      }
}

TEST_CASE("segment: an open volume without background is refused", "[segment]") {
  for (const Coord& size : {Coord(1), Coord(3, 8, 16), Coord(17, 2, 9)}) {
    ObjectVolume object(boxAt(Coord(-8), size), 1);
    SegmentOptions options;
    options.domain = object.box();
    CHECK_THROWS_AS(segment(*toMask(object), options), InvalidInput);
    CHECK_THROWS_AS(segment(*toMask(object, Tiles::wherePossible), options), InvalidInput);
    options.boundary = Boundary::closed;
    CHECK(segment(*toMask(object), options).counts.grains >= 1);
    options.boundary = Boundary::open;
    CoordBBox larger = object.box();
    ++larger.max().z();
    options.domain = larger;
    CHECK(segment(*toMask(object), options).counts.grains >= 1);
  }
}

TEST_CASE("segment: objects beyond the limits are refused at once", "[segment]") {
  const auto mask = MaskGrid::create();
  SECTION("too many leaves in a tile") {
    mask->tree().addTile(3, Coord(0), true, true);  // 4096^3 voxels
    CHECK_THROWS_AS(segment(*mask), InvalidInput);
  }
  SECTION("too long") {
    constexpr int kLongest = kMaxExtent;
    for (int axis = 0; axis < 3; ++axis) {
      Coord far(5);
      far[axis] -= kLongest - 1;
      mask->clear();
      mask->tree().setValueOn(Coord(5));
      mask->tree().setValueOn(far);
      CHECK(segment(*mask).counts.grains == 2);
      --far[axis];
      mask->tree().setValueOn(far);
      CHECK_THROWS_AS(segment(*mask), InvalidInput);
    }
  }
  SECTION("too far out") {
    constexpr int kFarthest = kMaxCoordinate;
    for (int axis = 0; axis < 3; ++axis)
      for (const int sign : {-1, 1}) {
        Coord far(0);
        far[axis] = sign * kFarthest;
        mask->clear();
        mask->tree().setValueOn(far);
        CHECK(segment(*mask).counts.grains == 1);
        far[axis] += sign;
        mask->tree().setValueOn(far);
        CHECK_THROWS_AS(segment(*mask), InvalidInput);
      }
  }
}

TEST_CASE("segment: cavities get no label, and their balls are those of the body", "[segment]") {
  // A ball of radius 9 with a hole in its center: one grain with the hole filled, hollow without.
  ObjectVolume object(boxAt(Coord(-10), Coord(21)));
  for (int i = 0; i < object.size(); ++i) {
    const Coord p = object.coord(i);
    object[i] = p.x() * p.x() + p.y() * p.y() + p.z() * p.z() <= 81 && p != Coord(0);
  }
  SegmentOptions options;
  options.keepDistance = options.keepManifold = true;
  const Segmentation s = segment(*toMask(object), options);
  CHECK(s.counts.cavities == 1);
  CHECK(s.counts.cavityVoxels == 1);
  CHECK(s.counts.objectVoxels == countObject(object));
  CHECK(s.counts.grains == 1);
  CHECK(s.counts.largestSquaredDistance >= 81);
  for (const auto& grid : {s.grain, s.distanceSquared, s.manifold}) {
    CHECK_FALSE(grid->tree().isValueOn(Coord(0)));
    CHECK(grid->tree().getValue(Coord(0)) == 0);
    CHECK(int64_t(grid->activeVoxelCount()) == countObject(object));
  }
  options.fillHoles = 0;
  CHECK(segment(*toMask(object), options).counts.largestSquaredDistance < 40);
}
