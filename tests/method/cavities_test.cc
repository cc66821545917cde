// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/method/cavities.h"

#include <optional>
#include <string>

#include "support/by_rank.h"
#include "support/catch.h"
#include "support/oracle.h"
#include "support/random_volume.h"
#include "support/runs.h"
#include "vdb_madf/base/errors.h"

namespace {

using namespace vdb_madf;
using namespace vdb_madf::test;

constexpr int64_t kAll = 1000000;

/// A shell one voxel thick around a room of the given size.
ObjectVolume shell(const Coord& room, const Coord& origin = Coord(0)) {
  ObjectVolume object(boxAt(origin, room.offsetBy(2)), 1);
  for (int i = 0; i < object.size(); ++i)
    if (boxAt(origin.offsetBy(1), room).isInside(object.coord(i))) object[i] = 0;
  return object;
}

Cavities find(const ObjectVolume& object, const std::optional<CoordBBox>& domain, bool open,
              int64_t fillHoles) {
  return findCavities(LeafIndex(*toMask(object)), domain, open, fillHoles);
}

/// The voxels that are filled.
ObjectVolume voxelsOf(const Cavities& cavities, const CoordBBox& box) {
  ObjectVolume result(box);
  for (const auto& leaf : cavities.leaves)
    for (uint32_t k = 0; k < 512; ++k)
      if (leaf.mask[k >> 6] >> (k & 63) & 1)
        result[leaf.origin.offsetBy(int(k >> 6), int(k >> 3 & 7), int(k & 7))] = 1;
  return result;
}

}  // namespace

TEST_CASE("cavities: fewer voxels than asked for", "[cavities]") {
  const ObjectVolume object = shell({3, 3, 3});
  for (const bool known : {false, true}) {
    const auto domain = known ? std::optional(boxAt(Coord(-1), Coord(7))) : std::nullopt;
    CHECK(find(object, domain, known, 27).count == 0);
    const Cavities found = find(object, domain, known, 28);
    CHECK(found.count == 1);
    CHECK(found.voxels == 27);
  }
}

TEST_CASE("cavities: rooms of whole leaves, where the object touches none", "[cavities]") {
  // The room holds up to 27 untouched leaves; from (-8, 8, 16) on its walls lie in leaves of their
  // own.
  for (const int side : {8, 9, 17, 24, 30})
    for (const Coord& origin : {Coord(-9, 7, 15), Coord(-9, 6, 15), Coord(-4, 5, 6)}) {
      const ObjectVolume object = shell(Coord(side), origin);
      const int64_t voxels = int64_t(side) * side * side;
      CHECK(find(object, {}, false, voxels).count == 0);
      const Cavities found = find(object, {}, false, voxels + 1);
      CHECK(found.count == 1);
      CHECK(found.voxels == voxels);
      CHECK(countObject(voxelsOf(found, object.box())) == voxels);
    }
}

TEST_CASE("cavities: what reaches a face of the domain", "[cavities]") {
  // A dent in a block, open towards +x, and a hole inside.
  ObjectVolume object(boxAt({0, 0, 0}, {9, 9, 9}), 1);
  object[Coord(8, 4, 4)] = 0;
  object[Coord(4, 4, 4)] = 0;
  object[Coord(0, 0, 0)] = object[Coord(0, 0, 1)] = object[Coord(0, 0, 2)] = 0;
  CHECK(find(object, object.box(), true, 3).count == 2);   // faces of the domain are no matter
  CHECK(find(object, object.box(), false, 3).count == 1);  // beyond them lies background
  CHECK(find(object, {}, false, 3).count == 1);            // the dent is part of the outside
  CHECK(find(object, boxAt({0, 0, 0}, {10, 9, 9}), true, 3).count == 1);     // 82 voxels together
  CHECK(find(object, boxAt({0, 0, 0}, {10, 9, 9}), true, kAll).count == 0);  // none would be left
  CHECK(find(object, boxAt({0, 0, 0}, {10, 9, 9}), false, kAll).count == 1);
}

TEST_CASE("cavities: all or nothing if no background would be left", "[cavities]") {
  const ObjectVolume object = shell({2, 2, 2});
  CHECK(find(object, object.box(), true, 100).count == 0);
  CHECK(find(object, object.box(), false, 100).count == 1);
  CoordBBox larger = object.box();
  larger.max().x() += 1;
  CHECK(find(object, larger, true, 10).count == 1);
  CHECK(find(object, larger, true, kAll).count == 0);
}

TEST_CASE("cavities: nothing to fill", "[cavities]") {
  CHECK(find(ObjectVolume(), {}, false, 27).count == 0);
  CHECK(find(ObjectVolume(), boxAt(Coord(0), Coord(2)), true, 27).count == 0);
  for (const int64_t off : {0, 1}) CHECK(find(shell(Coord(1)), {}, false, off).count == 0);
}

TEST_CASE("cavities: the default in domains one voxel thick", "[cavities]") {
  CHECK(defaultFillHoles({}) == 27);
  CHECK(defaultFillHoles(boxAt(Coord(3), Coord(2))) == 27);
  for (int axis = 0; axis < 3; ++axis) {
    Coord dim(5);
    dim[axis] = 1;
    CHECK(defaultFillHoles(boxAt(Coord(3), dim)) == 0);
  }
}

TEST_CASE("cavities: agree with the oracle", "[cavities]") {
  int filled = 0;
  for (uint64_t seed = 1; seed <= 1500; ++seed) {
    Rng rng(seed);
    const Coord size(rng.between(1, 26), rng.between(1, 20), rng.between(1, 20));
    const auto kind = VolumeKind(int(seed) % kVolumeKinds);
    const ObjectVolume object = randomVolume(kind, boxAt(randomOrigin(rng), size), rng);
    const std::optional<CoordBBox> domain = randomDomain(object, rng);
    const bool open = domain && rng.chance(0.5);
    const int64_t holes[] = {0, 1, 2, 3, 10, 27, 100, 600, kAll};
    const int64_t fillHoles = holes[rng.below(9)];
    const Cavities found = find(object, domain, open, fillHoles);
    const OracleBody expected = oracleBody(object, domain, open, fillHoles);
    INFO("seed " << seed << ", " << name(kind) << ", fill " << fillHoles << (open ? ", open" : ""));
    REQUIRE(found.count == expected.cavities);
    REQUIRE(found.voxels == countObject(expected.voxels) - countObject(object));
    ObjectVolume body = voxelsOf(found, expected.voxels.box());
    for (int i = 0; i < body.size(); ++i) body[i] |= object.get(body.coord(i), 0);
    REQUIRE(body == expected.voxels);
    filled += found.count > 0;

    const LeafIndex before(*toMask(object)), after(before, found.leaves);
    std::vector<VoxelId> ids;
    forEachId(after, [&](VoxelId id) {
      if (!object.get(after.coord(id), 0)) ids.push_back(id);
    });
    REQUIRE(cavityVoxels(after, found) == ids);
  }
  CHECK(filled > 100);
}

TEST_CASE("cavities: threads do not matter, and interruption stops", "[cavities]") {
  Rng rng(3);
  const ObjectVolume object =
      randomVolume(VolumeKind::pinholes, boxAt({-30, 5, 9}, {60, 50, 40}), rng);
  const LeafIndex index(*toMask(object));
  const Cavities one = withThreads(1, [&] { return findCavities(index, {}, false, 27); });
  const Cavities four = withThreads(4, [&] { return findCavities(index, {}, false, 27); });
  CHECK(one.count > 0);
  CHECK(one.count == four.count);
  CHECK(cavityVoxels(LeafIndex(index, one.leaves), one) ==
        cavityVoxels(LeafIndex(index, four.leaves), four));
  StopAtOnce stop;
  CHECK_THROWS_AS(findCavities(index, {}, false, 27, &stop), Interrupted);
}
