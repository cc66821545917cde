// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/method/tidy.h"

#include <algorithm>
#include <cctype>
#include <string>
#include <utility>
#include <vector>

#include "support/by_rank.h"
#include "support/catch.h"
#include "support/oracle.h"
#include "support/random_volume.h"
#include "support/runs.h"
#include "vdb_madf/base/errors.h"

namespace {

using namespace vdb_madf;
using namespace vdb_madf::test;
using Labels = DenseVolume<int64_t>;

ObjectVolume objectOf(const Labels& labels) {
  ObjectVolume object(labels.box());
  for (int i = 0; i < labels.size(); ++i) object[i] = labels[i] != 0;
  return object;
}

/// Labels by letters in rows along z, separated by '/': 'a' is 1. Anchors are capital letters.
struct Picture {
  Labels labels;
  std::vector<Coord> representatives;
  explicit Picture(const std::string& text) {
    const auto width = int(text.find('/') == std::string::npos ? text.size() : text.find('/'));
    const auto height = int(std::count(text.begin(), text.end(), '/')) + 1;
    labels = Labels(boxAt(Coord(0), {1, height, width}));
    int i = 0;
    for (const char c : text) {
      if (c == '/') continue;
      const int label = std::isalpha(c) ? std::tolower(c) - 'a' + 1 : 0;
      if (std::isupper(c)) {
        representatives.resize(std::max(representatives.size(), size_t(label)));
        representatives[size_t(label) - 1] = labels.coord(i);
      }
      labels[i++] = label;
    }
  }
};

std::string labelText(const Labels& labels) {
  std::string result;
  const Coord dim = labels.box().dim();
  for (int y = 0; y < dim.y(); ++y) {
    if (y > 0) result += '/';
    for (int z = 0; z < dim.z(); ++z) {
      const int64_t label = labels[Coord(0, y, z)];
      result += label ? char('a' + label - 1) : '.';
    }
  }
  return result;
}

/// Voxels where `body` alone is set belong to no grain.
Labels tidied(const Labels& labels, const ObjectVolume& body,
              const std::vector<Coord>& representatives, int rounds) {
  const LeafIndex index(*toMask(body));
  GrainLabels grains;
  grains.label = byRank<uint32_t>(index, [&](const Coord& p) { return labels.get(p, 0); });
  grains.representative = representatives;
  grains.voxels.resize(representatives.size());
  for (int i = 0; i < labels.size(); ++i)
    if (labels[i]) ++grains.voxels[size_t(labels[i] - 1)];
  tidy(index, rounds, grains);
  const Labels result = dense(index, grains.label, body.box());
  std::vector<int64_t> voxels(representatives.size(), 0);
  for (int i = 0; i < result.size(); ++i)
    if (result[i]) ++voxels[size_t(result[i] - 1)];
  CHECK(voxels == grains.voxels);
  return result;
}

/// As the library and the oracle have it.
std::string tidied(const std::string& picture, int rounds) {
  const Picture p(picture);
  const Labels result = tidied(p.labels, objectOf(p.labels), p.representatives, rounds);
  CHECK(result == oracleTidy(p.labels, p.representatives, rounds));
  return labelText(result);
}

/// Labels by the nearest of some seeds, some voxels changed at random: combs and crumbs.
Labels randomLabels(const ObjectVolume& object, int grains, double noise, Rng& rng,
                    std::vector<Coord>& representatives) {
  std::vector<Coord> seeds;
  for (int g = 0; g < grains; ++g) seeds.push_back(object.coord(rng.below(object.size())));
  Labels labels(object.box());
  std::vector<int64_t> numbers(size_t(grains), 0);
  for (int i = 0; i < object.size(); ++i) {
    if (!object[i]) continue;
    size_t nearest = 0;
    for (size_t g = 1; g < seeds.size(); ++g)
      if ((object.coord(i) - seeds[g]).asVec3d().lengthSqr() <
          (object.coord(i) - seeds[nearest]).asVec3d().lengthSqr())
        nearest = g;
    if (rng.chance(noise)) nearest = size_t(rng.below(grains));
    int64_t& number = numbers[nearest];
    if (number == 0) {  // its first voxel stands for it
      representatives.push_back(object.coord(i));
      number = int64_t(representatives.size());
    }
    labels[i] = number;
  }
  return labels;
}

}  // namespace

TEST_CASE("tidy: a comb becomes straight, an anchor stays", "[tidy]") {
  CHECK(tidied("Aaabbb/aaaabb/aaabbb/aaaabb/aaabbB", 2) == "aaabbb/aaabbb/aaabbb/aaabbb/aaabbb");
  CHECK(tidied("aabb/aaAb/Babb/aaab", 0) == "aabb/aaab/babb/aaab");
  // A single voxel that is the anchor of its grain.
  CHECK(tidied("Aaa/aBa/aaa", 3) == "aaa/aba/aaa");
}

TEST_CASE("tidy: of equally frequent labels the own, then the smallest", "[tidy]") {
  CHECK(tidied("AabB", 1) == "aabb");
  // Around the upper c: one c, three of a and of b.
  CHECK(tidied("aAa/.c./bBb/.../..C", 1) == "aaa/.a./bbb/.../..c");
}

TEST_CASE("tidy: rounds are synchronous", "[tidy]") {
  // Sequential updates would eat the checkerboard from one corner.
  const std::string board = "Abababa/bababab/abababa/bababaB";
  for (const int rounds : {1, 2, 3}) tidied(board, rounds);
}

TEST_CASE("tidy: loose pieces of a grain go to their neighbors", "[tidy]") {
  // The two a on the right are not connected with the anchor; smoothing does not move them.
  CHECK(tidied("AabbbBb/aabbbaa/aabbbaa/aabbbaa/aabbbbb", 1) ==
        "aabbbbb/aabbbbb/aabbbbb/aabbbbb/aabbbbb");
  // A piece across a pore keeps its label: nothing is glued, and nobody else is there.
  CHECK(tidied("Aa.aa", 1) == "aa.aa");
}

TEST_CASE("tidy: a representative in a cavity", "[tidy]") {
  // The anchor is the voxel of the grain nearest to it, then of smaller coordinate.
  const Picture p("aaabb/a.bbb/aaabb");
  const ObjectVolume body(p.labels.box(), 1);
  const std::vector<Coord> representatives{Coord(0, 1, 1), Coord(0, 1, 3)};
  for (const int rounds : {1, 2})
    CHECK(tidied(p.labels, body, representatives, rounds) ==
          oracleTidy(p.labels, representatives, rounds));
}

TEST_CASE("tidy: agrees with the oracle", "[tidy]") {
  for (uint64_t seed = 1; seed <= 700; ++seed) {
    Rng rng(seed);
    const Coord size(rng.between(1, 20), rng.between(1, 18), rng.between(1, 18));
    const auto kind = VolumeKind(int(seed) % kVolumeKinds);
    const ObjectVolume object = randomVolume(kind, boxAt(randomOrigin(rng), size), rng);
    if (countObject(object) == 0) continue;
    std::vector<Coord> representatives;
    const Labels labels =
        randomLabels(object, rng.between(1, 9), rng.chance(0.5) ? 0.05 : 0.4, rng, representatives);
    // Some voxels become cavities, representatives among them.
    Labels given = labels;
    std::vector<int64_t> left(representatives.size(), 0);
    for (int i = 0; i < given.size(); ++i)
      if (given[i]) ++left[size_t(given[i] - 1)];
    if (rng.chance(0.5))
      for (int i = 0; i < given.size(); ++i)
        if (given[i] && left[size_t(given[i] - 1)] > 1 && rng.chance(0.03)) {
          --left[size_t(given[i] - 1)];
          given[i] = 0;
        }
    const int rounds = rng.between(0, 4);
    INFO("seed " << seed << ", " << name(kind) << ", " << rounds << " rounds");
    REQUIRE(tidied(given, object, representatives, rounds) ==
            oracleTidy(given, representatives, rounds));
  }
}

TEST_CASE("tidy: threads do not matter, nor where the object lies", "[tidy]") {
  Rng rng(5);
  const ObjectVolume object =
      randomVolume(VolumeKind::roughBalls, boxAt({-33, 10, -70}, {50, 60, 55}), rng);
  std::vector<Coord> representatives;
  const Labels labels = randomLabels(object, 20, 0.2, rng, representatives);
  const Labels expected =
      withThreads(1, [&] { return tidied(labels, object, representatives, 2); });
  CHECK(withThreads(4, [&] { return tidied(labels, object, representatives, 2); }) == expected);
  for (const Coord& by : {Coord(1, 2, 3), Coord(-5, 4, 7)}) {
    const ObjectVolume moved = translated(object, by);
    Labels there(moved.box());
    for (int i = 0; i < there.size(); ++i) there[i] = labels[i];
    std::vector<Coord> seeds;
    for (const Coord& p : representatives) seeds.push_back(p + by);
    const Labels result = tidied(there, moved, seeds, 2);
    bool same = true;
    for (int i = 0; i < result.size(); ++i) same = same && result[i] == expected[i];
    CHECK(same);
  }
}

TEST_CASE("tidy: bad options, and interruption", "[tidy]") {
  const LeafIndex index(*toMask(ObjectVolume(boxAt(Coord(0), Coord(9)), 1)));
  GrainLabels grains;
  grains.label = byRank<uint32_t>(index, [](const Coord&) { return 1; });
  grains.representative = {Coord(4)};
  grains.voxels = {729};
  CHECK_THROWS_AS(tidy(index, -1, grains), InvalidInput);
  CHECK_THROWS_AS(tidy(index, kMaxTidy + 1, grains), InvalidInput);
  StopAtOnce stop;
  CHECK_THROWS_AS(tidy(index, 1, grains, &stop), Interrupted);
}
