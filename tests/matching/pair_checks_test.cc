// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/matching/pair_checks.h"

#include "support/catch.h"
#include "support/label_shapes.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/grids/grid_metadata.h"

using namespace vdb_madf;
using namespace vdb_madf::test;
using vdb_madf::test::Contains;

namespace {

constexpr int kPairSide = 20;
const PairNames kPairNames{"a", "b", "--shift", "--max-shift"};

/// A block of noise, of which each seed has another.
Int32Grid::Ptr noise(unsigned seed, int percentFilled) {
  const Int32Grid::Ptr labels =
      labelGrid(randomLabels(seed, Coord(0), kPairSide, 5, percentFilled));
  setDomain(*labels, cube(kPairSide));
  return labels;
}

std::vector<std::string> trackNotes(const Int32Grid& before, const Int32Grid& after,
                                    const TrackOptions& options = {}) {
  return notesOn(track(before, after, options), before, after, options, kPairNames);
}

}  // namespace

TEST_CASE("pair_checks: voxels have to be of one size, where both are known", "[pair_checks]") {
  const Int32Grid::Ptr first = noise(1, 30), second = noise(1, 30);
  checkSameVoxels(*first, *second, kPairNames);
  setVoxelSize(*first, VoxelSize(1e-5));
  checkSameVoxels(*first, *second, kPairNames);
  setVoxelSize(*second, VoxelSize(1.0005e-5));
  checkSameVoxels(*first, *second, kPairNames);
  setVoxelSize(*second, VoxelSize(2e-5));
  CHECK_THROWS_WITH(checkSameVoxels(*first, *second, kPairNames),
                    Equals("b: its voxels are 2 times as long as those of a: give labels of the "
                           "same voxels"));
  setVoxelSize(*second, VoxelSize({1e-5, 1e-5, 3e-5}));
  CHECK_THROWS_WITH(checkSameVoxels(*first, *second, kPairNames), Contains("1, 1, 3 times"));
}

TEST_CASE("pair_checks: labels without a common voxel are refused", "[pair_checks]") {
  const Int32Grid::Ptr first = labelGrid({{{0, 0, 0}, 1}}), second = labelGrid({{{50, 0, 0}, 1}}),
                       none = labelGrid({});
  CHECK_THROWS_WITH(checkAnyCommon(compare(*first, *second), kPairNames),
                    Contains("b: no voxel is labeled both here and in a"));
  CHECK_THROWS_WITH(checkAnyCommon(track(*first, *second), kPairNames),
                    Contains("b: no labeled voxel") && Contains("(--shift, --max-shift)"));
  checkAnyCommon(compare(*first, *first), kPairNames);
  checkAnyCommon(compare(*none, *none), kPairNames);
  checkAnyCommon(track(*first, *none), kPairNames);
}

TEST_CASE("pair_checks: what differs between the two of a comparison is said", "[pair_checks]") {
  const Int32Grid::Ptr first = noise(1, 30), same = noise(1, 30), other = noise(2, 30);
  const auto notes = [&](const Int32Grid& truth, const Int32Grid& test) {
    return notesOn(compare(truth, test), truth, test);
  };
  CHECK(notes(*first, *same).empty());
  REQUIRE(notes(*first, *other).size() == 1);
  CHECK_THAT(notes(*first, *other)[0], Contains("differ in topology"));
  setDomain(*same, cube(kPairSide + 1));
  REQUIRE(notes(*first, *same).size() == 1);
  CHECK_THAT(notes(*first, *same)[0],
             Contains("the domains differ: [0, 0, 0] to [19, 19, 19] and [0, 0, 0] to [20, 20"));
  const Int32Grid::Ptr moved = first->deepCopy();
  for (const Int32Grid::Ptr& grid : {first, moved}) setVoxelSize(*grid, VoxelSize(1e-5));
  CHECK(notes(*first, *moved).empty());
  moved->setTransform(first->transform().copy());
  moved->transform().preTranslate(openvdb::Vec3d(0, 3, 0.3));
  REQUIRE(notes(*first, *moved).size() == 1);
  CHECK_THAT(notes(*first, *moved)[0], Contains("differ by 0.0, -3.0, -0.3 voxels; voxels of"));
}

TEST_CASE("pair_checks: tracks of unrelated samples are said to be", "[pair_checks]") {
  for (const int percentFilled : {10, 30, 60}) {
    CAPTURE(percentFilled);
    const Int32Grid::Ptr before = noise(1, percentFilled), after = noise(2, percentFilled);
    const auto notes = trackNotes(*before, *after, {Coord(0)});
    REQUIRE(notes.size() == 1);
    CHECK_THAT(notes[0], Contains("b: has ") && Contains("of unrelated samples"));
    CHECK(trackNotes(*before, *before).empty());
    // Half of the grains are gone, all that is left was there.
    LabelMap voxels = randomLabels(1, Coord(0), kPairSide, 5, percentFilled);
    for (auto voxel = voxels.begin(); voxel != voxels.end();)
      voxel = voxel->second < 3 ? voxels.erase(voxel) : std::next(voxel);
    const Int32Grid::Ptr fewer = labelGrid(voxels);
    setDomain(*fewer, cube(kPairSide));
    CHECK(trackNotes(*before, *fewer).empty());
  }
  // All is solid: more cannot be common.
  const Int32Grid::Ptr solid = noise(1, 100);
  CHECK(trackNotes(*solid, *noise(2, 100), {Coord(0)}).empty());
}

TEST_CASE("pair_checks: a shift at the end of what is looked for is said", "[pair_checks]") {
  const Int32Grid::Ptr before = labelGrid(randomLabels(3, Coord(0), 12, 5, 40)),
                       after = labelGrid(randomLabels(3, Coord(2, 0, -1), 12, 5, 40));
  TrackOptions options;
  options.maxShift = 2;
  REQUIRE(trackNotes(*before, *after, options).size() == 1);
  CHECK_THAT(trackNotes(*before, *after, options)[0], Contains("try 4 (--max-shift)"));
  CHECK(trackNotes(*before, *after).empty());
  options.shift = Coord(2, 0, -1);
  CHECK(trackNotes(*before, *after, options).empty());
}
