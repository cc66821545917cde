// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/segmentation/label_flaws.h"

#include <optional>
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

void fill(Labels& labels, const CoordBBox& box, int64_t label) {
  for (int i = 0; i < labels.size(); ++i)
    if (box.isInside(labels.coord(i))) labels[i] = label;
}

LabelFlaws flawsOf(const Labels& labels, int64_t grains, const std::optional<CoordBBox>& domain) {
  ObjectVolume object(labels.box());
  std::vector<int64_t> voxels(size_t(grains), 0);
  for (int i = 0; i < labels.size(); ++i) {
    object[i] = labels[i] != 0;
    if (labels[i]) ++voxels[size_t(labels[i] - 1)];
  }
  const LeafIndex index(*toMask(object));
  return labelFlaws(index, byRank<uint32_t>(index, labels), voxels, domain);
}

void checkFlaws(const LabelFlaws& flaws, const LabelFlaws& expected) {
  CHECK(flaws.crumbs == expected.crumbs);
  CHECK(flaws.specks == expected.specks);
  CHECK(flaws.slivers == expected.slivers);
  CHECK(flaws.inPieces == expected.inPieces);
}

}  // namespace

TEST_CASE("label_flaws: a block, a slab on it, a crumb, and a speck", "[label_flaws]") {
  Labels labels(boxAt(Coord(-3), Coord(20)));
  fill(labels, boxAt({-2, -2, -2}, {10, 10, 10}), 1);
  fill(labels, boxAt({8, -2, -2}, {2, 10, 10}), 2);  // two voxels thick
  fill(labels, boxAt({-2, 8, -2}, {3, 3, 3}), 3);
  fill(labels, boxAt({14, 14, 14}, {2, 2, 2}), 4);
  const LabelFlaws expected = oracleFlaws(labels, 4, {});
  checkFlaws(flawsOf(labels, 4, {}), expected);
  checkFlaws(expected, {1, 1, 1, 0});
  // Three voxels thick: the middle is two layers deep, as the crumb's middle is.
  fill(labels, boxAt({8, -2, -2}, {3, 10, 10}), 2);
  checkFlaws(flawsOf(labels, 4, {}), {1, 1, 0, 0});
}

TEST_CASE("label_flaws: what a face of the domain cuts off does not count", "[label_flaws]") {
  // Two voxels thick at the face: may be deeper beyond.
  Labels labels(boxAt(Coord(0), Coord(12)));
  fill(labels, boxAt({0, 0, 0}, {2, 12, 12}), 1);
  fill(labels, boxAt({2, 0, 0}, {10, 12, 12}), 2);
  checkFlaws(flawsOf(labels, 2, labels.box()), {0, 0, 0, 0});
  checkFlaws(flawsOf(labels, 2, {}), {0, 0, 1, 0});
}

TEST_CASE("label_flaws: a grain in two pieces, in one leaf and in two", "[label_flaws]") {
  for (const int at : {0, 4, 6}) {
    Labels labels(boxAt(Coord(at), {1, 1, 9}));
    fill(labels, boxAt(Coord(at), {1, 1, 9}), 1);
    labels[4] = 2;
    checkFlaws(flawsOf(labels, 2, {}), {2, 0, 0, 1});
  }
}

TEST_CASE("label_flaws: agree with the oracle", "[label_flaws]") {
  LabelFlaws sum;
  for (uint64_t seed = 1; seed <= 600; ++seed) {
    Rng rng(seed);
    const Coord size(rng.between(1, 24), rng.between(1, 18), rng.between(1, 18));
    const auto kind = VolumeKind(int(seed) % kVolumeKinds);
    const ObjectVolume object = randomVolume(kind, boxAt(randomOrigin(rng), size), rng);
    // Slabs of random thickness, each with a label; some voxels have none.
    const int grains = rng.between(1, 6), thickness = rng.between(1, 6), axis = rng.below(3);
    Labels labels(object.box());
    for (int i = 0; i < object.size(); ++i)
      if (object[i] && !rng.chance(0.01))
        labels[i] = 1 + (object.coord(i)[axis] + (1 << 30)) / thickness % grains;
    const std::optional<CoordBBox> domain = randomDomain(object, rng);
    INFO("seed " << seed << ", " << name(kind));
    const LabelFlaws expected = oracleFlaws(labels, grains, domain),
                     flaws = flawsOf(labels, grains, domain);
    checkFlaws(flaws, expected);
    sum.crumbs += flaws.crumbs;
    sum.specks += flaws.specks;
    sum.slivers += flaws.slivers;
    sum.inPieces += flaws.inPieces;
  }
  CHECK(sum.crumbs > 50);
  CHECK(sum.specks > 50);
  CHECK(sum.slivers > 50);
  CHECK(sum.inPieces > 50);
}

TEST_CASE("label_flaws: interruption stops", "[label_flaws]") {
  const LeafIndex index(*toMask(ObjectVolume(boxAt(Coord(0), Coord(9)), 1)));
  const auto labels = byRank<uint32_t>(index, [](const Coord&) { return 1; });
  StopAtOnce stop;
  CHECK_THROWS_AS(labelFlaws(index, labels, {729}, {}, &stop), Interrupted);
}
