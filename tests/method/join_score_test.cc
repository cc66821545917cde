// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

// Scores of pairs, against those that integers of any size give.

#include "vdb_madf/method/detail/join_score.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "support/catch.h"
#include "support/oracle.h"
#include "support/random_graph.h"
#include "vdb_madf/method/hierarchy.h"

namespace {

using namespace vdb_madf;
using namespace vdb_madf::test;
using vdb_madf::detail::JoinScore;

/// Of a pair of classes.
struct Case {
  int64_t voxelsA;
  int32_t topA;
  int64_t voxelsB;
  int32_t topB;
  int64_t faces;
  int32_t height;
};

int32_t score(const Case& c, const VoxelWeights& weights = {},
              const std::optional<int>& flatAxis = {}) {
  return JoinScore(weights, flatAxis)({c.voxelsA, c.topA, c.topA}, {c.voxelsB, c.topB, c.topB},
                                      c.faces, c.height);
}
int64_t slowScore(const Case& c, const VoxelWeights& weights = {}) {
  return oracleScore(c.voxelsA, c.topA, c.voxelsB, c.topB, c.faces, c.height, weights);
}

int64_t slowPlaneScore(const Case& c, int weightX = 1, int weightY = 1) {
  return oraclePlaneScore(c.voxelsA, c.topA, c.voxelsB, c.topB, c.faces, c.height, weightX,
                          weightY);
}

}  // namespace

TEST_CASE("hierarchy: logarithms and roots are floors", "[hierarchy]") {
  // A logarithm that never falls is a floor if it is one on either side of each step.
  int64_t last = 0;
  for (int step = 1; step < 43 * 256; ++step) {
    const long double power = std::exp2((long double)step / 256);
    const auto n = int64_t(std::ceil(power));
    if (step % 256 != 0) REQUIRE(n - power > 1e-6L);  // long double is sure enough
    if (step % 256 != 0) REQUIRE(power - (n - 1) > 1e-6L);
    CAPTURE(step, n);
    if (n == last) continue;  // several steps below one integer
    last = n;
    const auto highest = int64_t(std::floor(256 * std::log2((long double)n)));
    REQUIRE(detail::lg(n) == highest);
    if (n > 1) REQUIRE(detail::lg(n - 1) < step);
  }
  CHECK(detail::lg(1) == 0);
  CHECK(detail::lg(2) == 256);
  CHECK(detail::lg(3) == 405);
  CHECK(detail::lg(18) == 1067);
  CHECK(detail::lg(128) == 1792);
  CHECK(detail::lg(JoinScore::kMaxVoxels) == 11007);
  for (int64_t root : {0, 1, 2, 3, 255, 256, 65535, 65536, 11863282, (1 << 24) - 1}) {
    CHECK(detail::squareRoot(root * root) == root);
    CHECK(detail::squareRoot(root * root + root) == root);
    CHECK(detail::squareRoot(root * root + 2 * root) == root);
  }
}

TEST_CASE("hierarchy: scores, as integers of any size give them", "[hierarchy]") {
  const std::vector<std::pair<Case, int32_t>> cases = {
      {{1, 2, 1, 2, 1, 1}, 10416},
      {{1, 2, 1, 2, 0, 1}, 9136},
      {{1, 2, 8796093022207, 2147483647, 2147483647, 1}, 32992},
      {{8796093022207, 2147483647, 8796093022207, 2147483647, 2147483647, 1}, -94893158},
      {{8796093022207, 2147483647, 8796093022207, 2147483647, 2147483647, 2147483646}, 11058},
      {{8796093022207, 2147483647, 1, 2147483647, 2147483647, 1}, -94880667},
      {{1, 2147483647, 8796093022207, 2147483647, 0, 1}, -94872218},
      {{1, 2147483647, 1, 2147483647, 0, 1}, -94894232},
      {{1, 2147483647, 1, 2147483647, 2147483647, 2147483646}, 50939},
      {{1, 2, 8796093022207, 2147483647, 0, 1}, 26542},
      {{8796093022207, 2, 8796093022207, 2, 2147483647, 1}, 21034},
      {{8796093022207, 2, 1, 2, 2147483647, 1}, 23725},
      {{8796093022207, 2, 8796093022207, 2, 0, 1}, 4784},
      {{1, 2, 8796093022207, 2, 2147483647, 1}, 47400},
      {{8796093022207, 2147483646, 8796093022207, 2147483647, 1, 1073741823}, -27792818},
      {{4398046511104, 715776516, 4398046511105, 715776516, 1000000000, 715723009}, 7325},
      {{127, 9, 500, 16, 12, 8}, 4568},
      {{128, 9, 500, 16, 12, 8}, 4559},
      {{129, 9, 500, 16, 12, 8}, 4559},
      {{4096, 100, 4096, 100, 300, 99}, 6004},
      {{20000, 100, 20000, 100, 314, 99}, 6898},
      {{20000, 100, 20000, 101, 314, 90}, 5910},
      {{3000, 144, 90000, 400, 150, 60}, -3272},
      {{65536, 225, 65537, 225, 700, 224}, 6945},
      {{99999, 81, 1000000, 10000, 99, 80}, 3028},
      {{5, 3, 7, 3, 2, 2}, 8497},
      {{7, 5, 7, 5, 4, 3}, 8193},
      {{1000, 64, 1000, 64, 8191, 50}, 43659},
      {{33554432, 46340, 33554431, 46341, 1, 12345}, -208732},
  };
  for (const auto& [c, expected] : cases) {
    CAPTURE(c.voxelsA, c.topA, c.voxelsB, c.topB, c.faces, c.height);
    CHECK(score(c) == expected);
    CHECK(slowScore(c) == expected);
  }
  const std::vector<std::pair<std::pair<Case, VoxelWeights>, int32_t>> unequal = {
      {{{4096, 2500, 4096, 2600, 300, 2400}, {25, 25, 144}}, 7248},
      {{{1, 2, 3, 3, 1, 1}, {1, 1, 400}}, 10380},
      {{{3, 2, 3, 3, 0, 1}, {1, 1, 400}}, 7885},
      {{{5000, 90000, 6000, 1000000, 100, 45000}, {100000, 9, 77}}, -58105},
      {{{4096, 400, 4096, 404, 300, 396}, {4, 4, 4}}, 5968},
      {{{8796093022207, 2147483647, 8796093022207, 2147483647, 2147483647, 1}, {400000, 1, 400001}},
       -94882334},
  };
  for (const auto& [c, expected] : unequal) {
    CAPTURE(c.first.voxelsA, c.first.topA, c.second.toString());
    CHECK(score(c.first, c.second) == expected);
    CHECK(slowScore(c.first, c.second) == expected);
  }
}

TEST_CASE("hierarchy: a top that is not sure is what fits the neighbor", "[hierarchy]") {
  const JoinScore score({}, {});
  const auto of = [&](int32_t topA, int32_t sureA, int32_t topB, int32_t sureB, int height,
                      int64_t voxelsB = 5000) {
    return score({5000, topA, sureA}, {voxelsB, topB, sureB}, 200, height);
  };
  const auto known = [&](int32_t topA, int32_t topB, int height, int64_t voxelsB = 5000) {
    return of(topA, topA, topB, topB, height, voxelsB);
  };
  // The end of a rod, whose ball is larger than those within it, is no grain for its radius.
  CHECK(of(100, 100, 200, 0, 98) == known(100, 100, 98));
  CHECK(of(100, 100, 121, 110, 98) == known(100, 110, 98));            // some ball of it is known
  CHECK(of(100, 100, 200, 0, 98, 5001) == known(100, 200, 98, 5001));  // it is no end
  CHECK(of(100, 0, 121, 121, 60) == known(100, 121, 60));
  // Nothing is sure of either.
  CHECK(of(100, 0, 121, 95, 60) == known(95, 95, 60));
  CHECK(of(100, 0, 121, 95, 98) == known(98, 98, 98));
  CHECK(of(100, 99, 121, 95, 60) == known(99, 99, 60));
  CHECK(of(100, 0, 121, 0, 60) == known(90, 90, 60));
  CHECK(of(100, 0, 121, 0, 60, 5001) == known(90, 121, 60, 5001));
}

TEST_CASE("hierarchy: scores in a plane", "[hierarchy]") {
  const std::vector<std::pair<Case, int32_t>> cases = {
      {{1, 2, 1, 2, 1, 1}, 8174},
      {{1, 2, 1, 2, 0, 1}, 6638},
      {{1, 2, 8796093022207, 2147483647, 2147483647, 1}, 84709},
      {{8796093022207, 2147483647, 8796093022207, 2147483647, 2147483647, 1}, -59260357},
      {{8796093022207, 2147483647, 8796093022207, 2147483647, 2147483647, 2147483646}, 54778},
      {{8796093022207, 2147483647, 1, 2147483647, 2147483647, 1}, -59293378},
      {{1, 2147483647, 8796093022207, 2147483647, 0, 1}, -59274946},
      {{1, 2147483647, 1, 2147483647, 2147483647, 2147483646}, 56314},
      {{8796093022207, 2, 8796093022207, 2, 2147483647, 1}, 54248},
      {{63, 9, 500, 16, 6, 8}, 7124},
      {{64, 9, 500, 16, 6, 8}, 7112},
      {{65, 9, 500, 16, 6, 8}, 7112},
      {{400, 100, 400, 100, 20, 99}, 6491},
      {{4000, 100, 4000, 100, 20, 99}, 6533},
      {{1600, 100, 3000, 100, 20, 90}, 6784},
      {{900, 144, 9000, 400, 15, 60}, 1045},
      {{65536, 225, 65537, 225, 30, 224}, 5941},
      {{1000, 64, 1000, 64, 8191, 50}, 53588},
  };
  for (const auto& [c, expected] : cases) {
    CAPTURE(c.voxelsA, c.topA, c.voxelsB, c.topB, c.faces, c.height);
    CHECK(slowPlaneScore(c) == expected);
    // The edge along the flat axis does not count.
    for (const int axis : {0, 1, 2}) {
      VoxelWeights weights;
      (axis == 0 ? weights.x : axis == 1 ? weights.y : weights.z) = 7;
      CHECK(score(c, {}, axis) == expected);
      CHECK(score(c, weights, axis) == expected);
    }
  }
  CHECK(score({4096, 2500, 4096, 2600, 30, 2400}, {25, 9, 144}, 1) == 6732);
  CHECK(score({1, 2, 3, 3, 1, 1}, {3, 1, 400}, 0) == 8871);
  CHECK(score({5000, 90000, 6000, 1000000, 100, 45000}, {9, 77, 2}, 2) == -34098);
  CHECK(score({400, 400, 400, 404, 20, 396}, {4, 1, 4}, 1) == 6453);
  CHECK(score({8796093022207, 2147483647, 8796093022207, 2147483647, 2147483647, 1},
              {400000, 400001, 1}, 2) == -39007);

  Rng rng(1);
  for (int i = 0; i < 20000; ++i) {
    const auto top = [&] { return int32_t(1 + logarithmic(rng, 30.9)); };
    const auto [topA, topB] = std::minmax({top(), top()});
    const Case c{logarithmic(rng, 42.9),     topA,
                 logarithmic(rng, 42.9),     topB,
                 logarithmic(rng, 30.9) - 1, std::max(1, int32_t(topA * rng.unit()))};
    const int x = i % 2 ? rng.between(1, 30) : 1, y = i % 2 ? rng.between(1, 30) : 1;
    CAPTURE(c.voxelsA, c.topA, c.voxelsB, c.topB, c.faces, c.height, x, y);
    const int32_t whole = score(c, {x, y, 1}, 2);
    REQUIRE(whole == slowPlaneScore(c, x, y));
    Case larger = c;
    larger.voxelsB = std::min(c.voxelsB + logarithmic(rng, 42.9), JoinScore::kMaxVoxels);
    REQUIRE(score(larger, {x, y, 1}, 2) - 3 * detail::lg(larger.voxelsB) <=
            whole - 3 * detail::lg(c.voxelsB));
  }
}

TEST_CASE("hierarchy: a rod in a plane joins, however long its pieces are", "[hierarchy]") {
  for (int radius = 2; radius < 400; radius += 1 + radius / 5)
    for (double first = radius; first < 2e6; first *= 1.7)
      for (double second = first; second < 2e6; second *= 1.7) {
        const int width = 2 * radius;
        CAPTURE(radius, first, second);
        REQUIRE(score({int64_t(first * width), radius * radius, int64_t(second * width),
                       radius * radius, width, radius * radius},
                      {}, 2) >= 11 * Hierarchy::kUnitsOfScore);
      }
}

TEST_CASE("hierarchy: scores, as the definition has them", "[hierarchy]") {
  Rng rng(1);
  for (int i = 0; i < 20000; ++i) {
    const auto top = [&] { return int32_t(1 + logarithmic(rng, 30.9)); };
    const auto [topA, topB] = std::minmax({top(), top()});
    Case c{logarithmic(rng, 42.9),     topA,
           logarithmic(rng, 42.9),     topB,
           logarithmic(rng, 30.9) - 1, std::max(1, int32_t(topA * rng.unit()))};
    VoxelWeights weights;
    if (i % 2) weights = {rng.between(1, 30), rng.between(1, 30), rng.between(1, 30)};
    CAPTURE(c.voxelsA, c.topA, c.voxelsB, c.topB, c.faces, c.height, weights.toString());
    const int32_t whole = score(c, weights);
    REQUIRE(whole == slowScore(c, weights));
    // What is left without b's volume term does not grow with b.
    Case larger = c;
    larger.voxelsB += logarithmic(rng, 42.9);
    larger.voxelsB = std::min(larger.voxelsB, JoinScore::kMaxVoxels);
    REQUIRE(score(larger, weights) - 2 * detail::lg(larger.voxelsB) <=
            whole - 2 * detail::lg(c.voxelsB));
    // A common factor of the weights changes nothing.
    if (topB < (1 << 30) / 5) {
      for (int32_t* length : {&c.topA, &c.topB, &c.height}) *length *= 5;
      REQUIRE(score(c, {5 * weights.x, 5 * weights.y, 5 * weights.z}) == whole);
    }
  }
}
