// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/labels/detail/label_digest.h"

#include <set>

#include "support/catch.h"
#include "support/label_shapes.h"

using namespace vdb_madf;
using namespace vdb_madf::test;

namespace {

std::string digest(const Int32Grid& labels) {
  return detail::labelDigest(detail::LabelLeaves(labels, nullptr));
}

std::string digest(const LabelMap& voxels) {
  return digest(*labelGrid(voxels));
}

}  // namespace

TEST_CASE("label_digest: equal labels share it, however they are stored", "[label_digest]") {
  const auto whole = Int32Grid::create(0), tile = Int32Grid::create(0);
  whole->denseFill({Coord(-8, 0, 16), Coord(-1, 7, 23)}, 5);
  tile->tree().addTile(1, Coord(-8, 0, 16), 5, true);
  REQUIRE(tile->tree().leafCount() == 0);
  CHECK(digest(*whole) == digest(*tile));
  // Background and what is not active is no label.
  tile->tree().setValueOff(Coord(100), 3);
  tile->tree().setValueOn(Coord(200), -3);
  CHECK(digest(*whole) == digest(*tile));
  CHECK(digest(*whole).size() == 32);
  CHECK(digest(*whole).find_first_not_of("0123456789abcdef") == std::string::npos);
}

TEST_CASE("label_digest: every change of a voxel changes it", "[label_digest]") {
  const LabelMap voxels = randomLabels(7, Coord(-5), 11, 4, 60);
  std::set<std::string> digests{digest(LabelMap()), digest(voxels)};
  size_t expected = 2;
  const auto expectNew = [&](const LabelMap& changed) {
    digests.insert(digest(changed));
    CHECK(digests.size() == ++expected);
  };
  LabelMap moved, renamed, swapped;
  for (const auto& [p, label] : voxels) {
    moved[p + Coord(0, 0, 8)] = label;
    renamed[p] = label + 1;
    swapped[p] = label < 3 ? 3 - label : label;
  }
  expectNew(moved);
  expectNew(renamed);
  expectNew(swapped);
  int number = 0;
  for (const auto& [p, label] : voxels) {
    if (++number % 40 != 0) continue;
    LabelMap changed = voxels;
    changed.erase(p);
    expectNew(changed);
    changed[p] = label + 1;
    expectNew(changed);
  }
  CHECK(number > 400);
}

TEST_CASE("label_digest: it is that of its parts", "[label_digest]") {
  const LabelMap voxels = randomLabels(3, Coord(-11), 24, 4, 60);
  LabelMap below, above;
  for (const auto& [p, label] : voxels) (p.z() < 0 ? below : above)[p] = label;
  detail::LabelDigest sum;
  for (const LabelMap& part : {above, below})
    sum.add(detail::LabelLeaves(*labelGrid(part), nullptr));
  CHECK(sum.text() == digest(voxels));
}
