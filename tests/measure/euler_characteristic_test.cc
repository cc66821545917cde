// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/measure/detail/euler_characteristic.h"

#include <map>
#include <string>
#include <vector>

#include "support/catch.h"
#include "support/edge_cases.h"
#include "support/random_volume.h"
#include "support/runs.h"
#include "vdb_madf/base/errors.h"

namespace {

using namespace vdb_madf;
using namespace vdb_madf::test;

int64_t euler(const ObjectVolume& object, Tiles tiles = Tiles::none) {
  return detail::eulerCharacteristic(LeafIndex(*toMask(object, tiles)));
}

/// Voxels - edges + squares - cubes, one by one.
int64_t naiveEuler(const ObjectVolume& object) {
  int64_t sum = 0;
  for (int i = 0; i < object.size(); ++i)
    for (int cell = 0; cell < 8; ++cell) {  // the directions in which it extends
      bool full = true;
      for (int k = 0; k < 8; ++k)
        if ((k & cell) == k)
          full = full && object.get(object.coord(i) + Coord(k & 1, k >> 1 & 1, k >> 2), 0);
      if (full) sum += __builtin_popcount(unsigned(cell)) % 2 ? -1 : 1;
    }
  return sum;
}

/// Pieces of equal value in a sheet (one voxel thick along x), connected along edges alone or at
/// corners too.
int pieces(const ObjectVolume& sheet, uint8_t value, bool corners) {
  ObjectVolume left = sheet;
  int count = 0;
  for (int i = 0; i < left.size(); ++i) {
    if (left[i] != value) continue;
    ++count;
    left[i] = 2;
    std::vector<Coord> front{left.coord(i)};
    while (!front.empty()) {
      const Coord p = front.back();
      front.pop_back();
      for (int y = -1; y <= 1; ++y)
        for (int z = -1; z <= 1; ++z) {
          const Coord q = p + Coord(0, y, z);
          if ((y != 0 && z != 0 && !corners) || left.get(q, 2) != value) continue;
          left[q] = 2;
          front.push_back(q);
        }
    }
  }
  return count;
}

}  // namespace

TEST_CASE("euler_characteristic: drawn by hand", "[euler_characteristic]") {
  CHECK(euler(fromPicture("#")) == 1);
  CHECK(euler(fromPicture("##/##|##/##")) == 1);
  CHECK(euler(fromPicture("###/#.#/###")) == 0);                          // a ring
  CHECK(euler(fromPicture("#####/#.#.#/#####")) == -1);                   // two tunnels
  CHECK(euler(fromPicture("###/###/###|###/#.#/###|###/###/###")) == 2);  // a cavity
  CHECK(euler(fromPicture("#.#")) == 2);
  // Connected by faces: voxels that share an edge or a corner are apart, ...
  CHECK(euler(fromPicture("#./.#")) == 2);
  CHECK(euler(fromPicture("#./..|../.#")) == 2);
  // ... and background is connected through them: this cavity has a way out at a corner.
  CHECK(euler(fromPicture("###/###/###|###/#.#/###|###/###/##.")) == 1);
  // The whole edge frame of a cube: 12 edges, 8 corners.
  CHECK(euler(fromPicture("###/#.#/###|#.#/.../#.#|###/#.#/###")) == 8 - 12);
}

TEST_CASE("euler_characteristic: of edge cases", "[euler_characteristic]") {
  const std::map<std::string, int64_t> expected = {
      {"no voxels, no box", 0}, {"empty", 0}, {"two components", 2}, {"corner to corner", 2}};
  for (const EdgeCase& c : edgeCases()) {
    const auto known = expected.find(c.name.substr(0, c.name.find(", tiles")));
    CAPTURE(c.name);
    CHECK(euler(c.object, c.tiles) == (known == expected.end() ? 1 : known->second));
    CHECK(naiveEuler(c.object) == (known == expected.end() ? 1 : known->second));
  }
}

TEST_CASE("euler_characteristic: by the definition on random volumes", "[euler_characteristic]") {
  for (uint64_t seed = 1; seed <= 190; ++seed) {
    Rng rng(seed);
    const auto kind = VolumeKind(int(seed) % kVolumeKinds);
    const Coord size(rng.between(1, 26), rng.between(1, 26), rng.between(1, 26));
    const ObjectVolume object = randomVolume(kind, boxAt(randomOrigin(rng), size), rng);
    CAPTURE(seed, name(kind), toString(object.box()));
    REQUIRE(euler(object, seed % 2 ? Tiles::wherePossible : Tiles::none) == naiveEuler(object));
  }
}

TEST_CASE("euler_characteristic: of a sheet, its pieces less its holes", "[euler_characteristic]") {
  for (uint64_t seed = 1; seed <= 40; ++seed) {
    CAPTURE(seed);
    Rng rng(seed);
    const CoordBBox box = boxAt({3, -20, 5}, {1, rng.between(5, 40), rng.between(5, 40)});
    ObjectVolume sheet = randomVolume(VolumeKind::denseNoise, box, rng);
    const int whole = pieces(sheet, 1, false);
    CoordBBox around = box;
    around.min() -= Coord(0, 1, 1);
    around.max() += Coord(0, 1, 1);
    const int holes = pieces(withBox(sheet, around), 0, true) - 1;  // all but the outside
    for (const AxisMap& map : {AxisMap(), AxisMap{{1, 0, 2}, {}}, AxisMap{{1, 2, 0}, {}}})
      REQUIRE(euler(permuted(sheet, map)) == whole - holes);
  }
}

TEST_CASE("euler_characteristic: padded, moved, turned and mirrored it stays",
          "[euler_characteristic]") {
  for (uint64_t seed = 1; seed <= 6; ++seed) {
    CAPTURE(seed);
    Rng rng(seed);
    const CoordBBox box = boxAt({-6, 1, 40}, {17, 22, 19});
    const ObjectVolume object = randomVolume(VolumeKind::blurredNoise, box, rng);
    const int64_t expected = euler(object);
    for (int step = 1; step <= 8; ++step)
      REQUIRE(euler(translated(object, Coord(step, -step, 3 * step))) == expected);
    CoordBBox padded = box;
    padded.expand(9);
    REQUIRE(euler(withBox(object, padded)) == expected);
    const AxisMap map{{2, 0, 1}, {rng.chance(0.5), rng.chance(0.5), rng.chance(0.5)}};
    REQUIRE(euler(permuted(object, map)) == expected);
  }
}

TEST_CASE("euler_characteristic: of a union, that of the parts less that of what they share",
          "[euler_characteristic]") {
  // Halves that share a layer of voxels: inclusion and exclusion.
  for (uint64_t seed = 1; seed <= 30; ++seed) {
    CAPTURE(seed);
    Rng rng(seed);
    const CoordBBox box = boxAt(randomOrigin(rng), {20, 18, 17});
    const ObjectVolume object = randomVolume(VolumeKind::denseNoise, box, rng);
    const int axis = int(seed % 3);
    CoordBBox lower = box, upper = box;
    lower.max()[axis] = upper.min()[axis] = box.min()[axis] + rng.below(box.dim()[axis]);
    CoordBBox shared = lower;
    shared.intersect(upper);
    REQUIRE(euler(object) == euler(withBox(object, lower)) + euler(withBox(object, upper)) -
                                 euler(withBox(object, shared)));
  }
}

TEST_CASE("euler_characteristic: threads do not matter", "[euler_characteristic]") {
  Rng rng(4);  // more leaves than one task takes
  const ObjectVolume object =
      randomVolume(VolumeKind::denseNoise, boxAt({-1, -70, 3}, {3, 150, 160}), rng);
  const LeafIndex index(*toMask(object));
  REQUIRE(index.leafCount() > 512);
  for (const int threads : {1, 2, 4})
    CHECK(withThreads(threads, [&] { return detail::eulerCharacteristic(index); }) ==
          naiveEuler(object));
}

TEST_CASE("euler_characteristic: none once interrupted", "[euler_characteristic]") {
  const LeafIndex index(*toMask(fromPicture("##")));
  StopAtOnce stop;
  CHECK_THROWS_AS(detail::eulerCharacteristic(index, {}, &stop), Interrupted);
}
