// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/matching/compare.h"

#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <random>
#include <set>
#include <vector>

#include "support/catch.h"
#include "support/label_shapes.h"
#include "support/label_slabs.h"
#include "vdb_madf/base/errors.h"

using namespace vdb_madf;
using namespace vdb_madf::test;

namespace {

using LabelOf = std::function<int32_t(const Coord&)>;

/// Labels over a box; 0: inactive.
Int32Grid::Ptr labels(const CoordBBox& box, const LabelOf& labelOf) {
  auto grid = Int32Grid::create(0);
  auto accessor = grid->getAccessor();
  for (auto p = box.begin(); p; ++p)
    if (const int32_t label = labelOf(*p)) accessor.setValue(*p, label);
  return grid;
}

/// A row of voxels along z from the origin.
Int32Grid::Ptr row(const std::vector<int32_t>& values) {
  return labels({Coord(0), Coord(0, 0, int(values.size()) - 1)},
                [&](const Coord& p) { return values[size_t(p.z())]; });
}

/// By the definitions, from a dense walk and all pairs of voxels.
Comparison naiveComparison(const Int32Grid& truth, const Int32Grid& test, const CoordBBox& box) {
  Comparison result;
  std::set<int32_t> truthIds, testIds;
  std::vector<std::pair<int32_t, int32_t>> common;
  const auto truthAt = truth.getConstAccessor(), testAt = test.getConstAccessor();
  for (auto p = box.begin(); p; ++p) {
    const int32_t a = truthAt.isValueOn(*p) ? std::max(0, truthAt.getValue(*p)) : 0;
    const int32_t b = testAt.isValueOn(*p) ? std::max(0, testAt.getValue(*p)) : 0;
    if (a) truthIds.insert(a);
    if (b) testIds.insert(b);
    if (a && b) common.emplace_back(a, b);
    if (a && !b) ++result.truthOnlyVoxels;
    if (!a && b) ++result.testOnlyVoxels;
  }
  result.truthGrains = int64_t(truthIds.size());
  result.testGrains = int64_t(testIds.size());
  result.commonVoxels = int64_t(common.size());
  if (common.empty()) return result;

  std::map<int32_t, std::map<int32_t, int>> byTruth, byTest;
  for (const auto& [a, b] : common) {
    ++byTruth[a][b];
    ++byTest[b][a];
  }
  const auto n = double(common.size());
  const auto misclassified = [&](const auto& table) {
    int wrong = 0;
    for (const auto& [id, row] : table) {
      int all = 0, most = 0;
      for (const auto& [other, count] : row) {
        all += count;
        most = std::max(most, count);
      }
      wrong += all - most;
    }
    return 100 * wrong / n;
  };
  result.misclassifiedPercent = misclassified(byTruth);
  result.mirrorMisclassifiedPercent = misclassified(byTest);

  double both = 0, inTruth = 0, inTest = 0, all = 0;
  for (size_t i = 0; i < common.size(); ++i)
    for (size_t j = 0; j < i; ++j) {
      const bool a = common[i].first == common[j].first, b = common[i].second == common[j].second;
      both += a && b;
      inTruth += a;
      inTest += b;
      ++all;
    }
  const double expected = all ? inTruth * inTest / all : 0;
  const double range = (inTruth + inTest) / 2 - expected;
  result.adjustedRandIndex = range == 0 ? 1 : (both - expected) / range;

  // H(A | B) = H(A, B) - H(B)
  const auto entropy = [n](const auto& counts) {
    double sum = 0;
    for (const auto& [id, count] : counts) sum -= count / n * std::log2(count / n);
    return sum;
  };
  std::map<std::pair<int32_t, int32_t>, int> joint;
  std::map<int32_t, int> truthSizes, testSizes;
  for (const auto& pair : common) {
    ++joint[pair];
    ++truthSizes[pair.first];
    ++testSizes[pair.second];
  }
  result.variationSplit = entropy(joint) - entropy(truthSizes);
  result.variationMerge = entropy(joint) - entropy(testSizes);
  result.variationOfInformation = result.variationSplit + result.variationMerge;
  return result;
}

void requireEqual(const Comparison& a, const Comparison& b) {
  CHECK(a.truthGrains == b.truthGrains);
  CHECK(a.testGrains == b.testGrains);
  CHECK(a.commonVoxels == b.commonVoxels);
  CHECK(a.truthOnlyVoxels == b.truthOnlyVoxels);
  CHECK(a.testOnlyVoxels == b.testOnlyVoxels);
  CHECK(a.misclassifiedPercent == Approx(b.misclassifiedPercent).margin(1e-12));
  CHECK(a.mirrorMisclassifiedPercent == Approx(b.mirrorMisclassifiedPercent).margin(1e-12));
  CHECK(a.adjustedRandIndex == Approx(b.adjustedRandIndex).margin(1e-12));
  CHECK(a.variationSplit == Approx(b.variationSplit).margin(1e-12));
  CHECK(a.variationMerge == Approx(b.variationMerge).margin(1e-12));
  CHECK(a.variationOfInformation == Approx(b.variationOfInformation).margin(1e-12));
}

void requireSamePartition(const Comparison& c) {
  CHECK(c.misclassifiedPercent == 0);
  CHECK(c.mirrorMisclassifiedPercent == 0);
  CHECK(c.adjustedRandIndex == 1);
  CHECK(c.variationOfInformation == 0);
}

/// Labels in [0, count], mixed at random.
Int32Grid::Ptr mixedLabels(std::mt19937& random, const CoordBBox& box, int count) {
  return labels(box, [&](const Coord&) { return int32_t(random() % unsigned(count + 1)); });
}

/// Splits by the definition, from the confusion matrix alone: each test grain goes to the truth
/// grain that most of its voxels have. Exchanged roles give the merges.
std::map<int32_t, std::vector<int32_t>> naiveSplits(const std::vector<Overlap>& overlaps,
                                                    bool exchanged) {
  std::map<int32_t, std::map<int32_t, int64_t>> byPiece;
  for (const Overlap& o : overlaps)
    if (o.truth && o.test)
      byPiece[exchanged ? o.truth : o.test][exchanged ? o.test : o.truth] = o.voxels;
  std::map<int32_t, std::vector<int32_t>> parts;
  for (const auto& [piece, row] : byPiece) {
    const auto most = std::max_element(row.begin(), row.end(), [](const auto& a, const auto& b) {
      return a.second < b.second;  // the first of equals: the smallest id
    });
    parts[most->first].push_back(piece);
  }
  for (auto part = parts.begin(); part != parts.end();)
    part = part->second.size() < 2 ? parts.erase(part) : std::next(part);
  return parts;
}

std::map<int32_t, std::vector<int32_t>> asMap(const std::vector<GrainGroup>& groups) {
  std::map<int32_t, std::vector<int32_t>> map;
  for (const GrainGroup& group : groups) map[group.grain] = group.parts;
  return map;
}

/// |A and B| / |A or B| by counting voxels.
double naiveIou(const Int32Grid& truth, int32_t a, const Int32Grid& test, int32_t b,
                const CoordBBox& box) {
  int both = 0, either = 0;
  for (auto p = box.begin(); p; ++p) {
    const bool inA = truth.tree().getValue(*p) == a, inB = test.tree().getValue(*p) == b;
    both += inA && inB;
    either += inA || inB;
  }
  return both / double(either);
}

class Stop : public Interrupter {
 public:
  bool wasInterrupted(int) override { return true; }
};

}  // namespace

TEST_CASE("compare: a hand-drawn case", "[compare]") {
  // Two grains of 6 and 4 voxels, one voxel of the first given to the second.
  const auto truth = row({1, 1, 1, 1, 1, 1, 2, 2, 2, 2});
  const auto test = row({7, 7, 7, 7, 7, 9, 9, 9, 9, 9});
  const Comparison c = compare(*truth, *test);
  CHECK(c.truthGrains == 2);
  CHECK(c.testGrains == 2);
  CHECK(c.commonVoxels == 10);
  CHECK(c.misclassifiedPercent == Approx(10));
  CHECK(c.mirrorMisclassifiedPercent == Approx(10));
  // Pairs: 16 together in both, 21 and 20 in each, of 45.
  CHECK(c.adjustedRandIndex == Approx((16 - 21 * 20 / 45.0) / (20.5 - 21 * 20 / 45.0)));
  CHECK(c.variationSplit == Approx(0.5 * std::log2(6 / 5.0) + 0.1 * std::log2(6.0)));
  CHECK(c.variationMerge == Approx(0.1 * std::log2(5.0) + 0.4 * std::log2(5 / 4.0)));
  CHECK(c.variationOfInformation == Approx(0.750977).epsilon(1e-6));
}

TEST_CASE("compare: voxels labeled in one grid only are reported apart", "[compare]") {
  const Comparison c = compare(*row({1, 1, 1, 0, 0, 3}), *row({0, 5, 5, 5, 5, 0}));
  CHECK(c.truthGrains == 2);
  CHECK(c.testGrains == 1);
  CHECK(c.commonVoxels == 2);
  CHECK(c.truthOnlyVoxels == 2);
  CHECK(c.testOnlyVoxels == 2);
  requireSamePartition(c);
}

TEST_CASE("compare: several truth grains may share a test grain", "[compare]") {
  const Comparison merged = compare(*row({1, 1, 2, 2}), *row({4, 4, 4, 4}));
  CHECK(merged.misclassifiedPercent == 0);
  CHECK(merged.mirrorMisclassifiedPercent == 50);
  CHECK(merged.adjustedRandIndex == 0);
  CHECK(merged.variationSplit == 0);
  CHECK(merged.variationMerge == 1);
}

TEST_CASE("compare: a split grain", "[compare]") {
  const Comparison split = compare(*row({4, 4, 4, 4}), *row({1, 1, 2, 2}));
  CHECK(split.truthGrains == 1);
  CHECK(split.testGrains == 2);
  CHECK(split.misclassifiedPercent == 50);
  CHECK(split.mirrorMisclassifiedPercent == 0);
  CHECK(split.variationSplit == 1);
  CHECK(split.variationMerge == 0);
}

TEST_CASE("compare: over-segmentation shows in the mirror's roles", "[compare]") {
  // One grain of 1000 voxels from which ten single voxels come loose.
  const auto truth = labels(cube(10), [](const Coord&) { return 1; });
  const auto test =
      labels(cube(10), [](const Coord& p) { return p.x() == 5 && p.y() == 5 ? 2 + p.z() : 1; });
  const Comparison c = compare(*truth, *test);
  CHECK(c.testGrains == 11);
  CHECK(c.misclassifiedPercent == Approx(1));
  CHECK(c.mirrorMisclassifiedPercent == 0);
}

TEST_CASE("compare: names of the labels do not matter", "[compare]") {
  std::mt19937 random(3);
  const auto truth = mixedLabels(random, cube(12, Coord(-5)), 9);
  const auto renamed = truth->deepCopy();
  for (auto voxel = renamed->beginValueOn(); voxel; ++voxel)
    voxel.setValue(2147483647 - *voxel * 1000);
  requireSamePartition(compare(*truth, *truth));
  requireSamePartition(compare(*truth, *renamed));
}

TEST_CASE("compare: empty and disjoint grids", "[compare]") {
  const auto empty = Int32Grid::create(0);
  const auto one = row({1});
  const Comparison none = compare(*empty, *empty);
  CHECK(none.truthGrains + none.testGrains + none.commonVoxels == 0);
  requireSamePartition(none);

  const Comparison lost = compare(*one, *empty);
  CHECK(lost.truthGrains == 1);
  CHECK(lost.testGrains == 0);
  CHECK(lost.truthOnlyVoxels == 1);
  requireSamePartition(lost);

  const auto far = labels(cube(3, Coord(5000, -5000, 9)), [](const Coord&) { return 1; });
  const Comparison apart = compare(*one, *far);
  CHECK(apart.commonVoxels == 0);
  CHECK(apart.testOnlyVoxels == 27);
  requireSamePartition(apart);
  requireSamePartition(compare(*one, *one));
}

TEST_CASE("compare: only active positive voxels are labels", "[compare]") {
  auto truth = row({1, 1, 1, 1});
  truth->tree().setValueOff(Coord(0, 0, 0), 1);
  truth->tree().setValue(Coord(0, 0, 1), -8);
  truth->tree().setValue(Coord(0, 0, 2), 0);
  const Comparison c = compare(*truth, *row({1, 1, 1, 1}));
  CHECK(c.commonVoxels == 1);
  CHECK(c.testOnlyVoxels == 3);
  CHECK(c.truthGrains == 1);
}

TEST_CASE("compare: equals the definitions on random labels", "[compare]") {
  for (unsigned seed = 1; seed <= 12; ++seed) {
    CAPTURE(seed);
    std::mt19937 random(seed);
    const CoordBBox box({-3, -9, 5}, {3, -2, 14});
    const auto truth = mixedLabels(random, box, 1 + int(random() % 8));
    const auto test = seed % 3 == 0 ? labels(box,
                                             [&](const Coord& p) {
                                               const int32_t t = truth->tree().getValue(p);
                                               return random() % 8 ? t : int32_t(random() % 5);
                                             })
                                    : mixedLabels(random, box, 1 + int(random() % 20));
    requireEqual(compare(*truth, *test), naiveComparison(*truth, *test, box));
  }
}

TEST_CASE("compare: exchanging the roles mirrors the result", "[compare]") {
  std::mt19937 random(5);
  const auto truth = mixedLabels(random, cube(20), 4), test = mixedLabels(random, cube(17), 7);
  const Comparison there = compare(*truth, *test), back = compare(*test, *truth);
  CHECK(there.misclassifiedPercent == back.mirrorMisclassifiedPercent);
  CHECK(there.mirrorMisclassifiedPercent == back.misclassifiedPercent);
  CHECK(there.truthOnlyVoxels == back.testOnlyVoxels);
  CHECK(there.truthGrains == back.testGrains);
  CHECK(there.adjustedRandIndex == Approx(back.adjustedRandIndex));
  CHECK(there.variationSplit == Approx(back.variationMerge));
}

TEST_CASE("compare: tiles count as their voxels", "[compare]") {
  const auto tiled = Int32Grid::create(0);
  tiled->fill(CoordBBox(Coord(-128), Coord(127)), 3);
  tiled->fill(CoordBBox(Coord(0, 0, 0), Coord(7, 7, 15)), 5);
  tiled->fill(CoordBBox(Coord(1, 2, 3), Coord(4, 4, 4)), 6);
  const auto voxels = tiled->deepCopy();
  voxels->tree().voxelizeActiveTiles();
  REQUIRE(tiled->tree().activeTileCount() > 1);
  REQUIRE(voxels->tree().activeTileCount() == 0);

  std::mt19937 random(2);
  const auto other = mixedLabels(random, cube(40, Coord(-20)), 6);
  const Comparison expected = compare(*voxels, *other);
  CHECK(expected.commonVoxels + expected.truthOnlyVoxels == 256 * 256 * 256);
  requireEqual(compare(*tiled, *other), expected);
  requireSamePartition(compare(*tiled, *voxels));
  requireSamePartition(compare(*voxels, *tiled));
  CHECK(compare(*tiled, *tiled).commonVoxels == 256 * 256 * 256);
}

TEST_CASE("compare: a tile of the root is counted, not visited", "[compare]") {
  const auto truth = Int32Grid::create(0), test = Int32Grid::create(0);
  truth->tree().addTile(3, Coord(0), 1, true);
  test->tree().addTile(3, Coord(0), 2, true);
  test->tree().setValue(Coord(100, 200, 300), 9);
  const Comparison c = compare(*truth, *test);
  CHECK(c.commonVoxels == int64_t(4096) * 4096 * 4096);
  CHECK(c.testGrains == 2);
  // One voxel of 6.9e10 is wrong: the pairs do not fit into 64 bits.
  CHECK(c.misclassifiedPercent == Approx(100.0 / 4096 / 4096 / 4096));
  CHECK(std::isfinite(c.adjustedRandIndex));
  requireSamePartition(compare(*truth, *truth));
}

TEST_CASE("compare: a shift of both grids changes nothing", "[compare]") {
  std::mt19937 random(8);
  const auto truth = mixedLabels(random, cube(11), 5), test = mixedLabels(random, cube(11), 3);
  const Comparison expected = compare(*truth, *test);
  for (int shift = 1; shift <= 8; ++shift) {
    const Coord by(-shift, 2 * shift, shift);
    const auto shifted = [&](const Int32Grid& grid) {
      return labels(cube(11, by), [&](const Coord& p) { return grid.tree().getValue(p - by); });
    };
    requireEqual(compare(*shifted(*truth), *shifted(*test)), expected);
  }
}

TEST_CASE("compare: rows of the grains, drawn by hand", "[compare]") {
  // Truth 1 is split in 5 and 6; 2 and 3 went into 7; 4 was lost, 8 is new.
  const auto truth = row({1, 1, 1, 1, 2, 2, 3, 3, 3, 4, 0, 0});
  const auto test = row({5, 5, 5, 6, 7, 7, 7, 7, 0, 0, 8, 8});
  const Comparison c = compare(*truth, *test);
  REQUIRE(c.truthMatches.size() == 4);
  const GrainMatch& one = c.truthMatches[0];
  CHECK(one.grain == 1);
  CHECK(one.voxels == 4);
  CHECK(one.partner == 5);
  CHECK(one.overlapVoxels == 3);
  CHECK(one.intersectionOverUnion == 0.75);
  CHECK(one.pieces == 2);
  const GrainMatch& three = c.truthMatches[2];
  CHECK(three.partner == 7);
  CHECK(three.overlapVoxels == 2);
  CHECK(three.intersectionOverUnion == Approx(2 / 5.0));
  CHECK(three.pieces == 0);  // 7 shares as many voxels with 2, the smaller id
  const GrainMatch& four = c.truthMatches[3];
  CHECK(four.partner == 0);
  CHECK(four.intersectionOverUnion == 0);
  REQUIRE(c.testMatches.size() == 4);
  CHECK(c.testMatches[2].grain == 7);
  CHECK(c.testMatches[2].partner == 2);
  CHECK(c.testMatches[2].pieces == 2);
  CHECK(c.testMatches[3].partner == 0);

  CHECK(c.foundGrains == 1);  // 2 has exactly one half
  CHECK(c.meanIntersectionOverUnion == Approx((0.75 + 0.5 + 0.4 + 0) / 4));
  CHECK(c.splits == 1);
  CHECK(c.merges == 1);
  CHECK(asMap(splits(c)) == std::map<int32_t, std::vector<int32_t>>{{1, {5, 6}}});
  CHECK(asMap(merges(c)) == std::map<int32_t, std::vector<int32_t>>{{7, {2, 3}}});
}

TEST_CASE("compare: a misplaced border splits and merges nothing", "[compare]") {
  const Comparison c = compare(*row({1, 1, 1, 1, 1, 2, 2, 2}), *row({1, 1, 1, 2, 2, 2, 2, 2}));
  CHECK(c.misclassifiedPercent == 25);
  CHECK(c.splits == 0);
  CHECK(c.merges == 0);
  CHECK(splits(c).empty());
  CHECK(merges(c).empty());
  CHECK(c.foundGrains == 2);
}

TEST_CASE("compare: rows of the grains equal the definitions on random labels", "[compare]") {
  for (unsigned seed = 1; seed <= 8; ++seed) {
    CAPTURE(seed);
    std::mt19937 random(seed);
    const CoordBBox box({-3, -9, 5}, {3, -2, 14});
    const auto truth = mixedLabels(random, box, 6);
    const auto test = mixedLabels(random, box, int(1 + random() % 90));
    const Comparison c = compare(*truth, *test);
    CHECK(asMap(splits(c)) == naiveSplits(c.overlaps, false));
    CHECK(asMap(merges(c)) == naiveSplits(c.overlaps, true));
    CHECK(c.splits == int64_t(splits(c).size()));
    CHECK(c.merges == int64_t(merges(c).size()));
    int64_t voxels = 0;
    for (const Overlap& overlap : c.overlaps) voxels += overlap.voxels;
    CHECK(voxels == c.commonVoxels + c.truthOnlyVoxels + c.testOnlyVoxels);
    double sum = 0;
    for (const GrainMatch& match : c.truthMatches) {
      const double iou = naiveIou(*truth, match.grain, *test, match.partner, box);
      CHECK(match.intersectionOverUnion == Approx(iou));
      sum += iou;
    }
    CHECK(c.meanIntersectionOverUnion == Approx(sum / double(c.truthMatches.size())));
  }
}

TEST_CASE("compare: threads do not matter", "[compare]") {
  std::mt19937 random(4);
  const auto truth = mixedLabels(random, cube(60), 40), test = mixedLabels(random, cube(60), 30);
  const Comparison parallel = compare(*truth, *test);
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const Comparison sequential = compare(*truth, *test);
  CHECK(parallel.adjustedRandIndex == sequential.adjustedRandIndex);
  CHECK(parallel.variationSplit == sequential.variationSplit);
  CHECK(parallel.variationMerge == sequential.variationMerge);
  CHECK(parallel.misclassifiedPercent == sequential.misclassifiedPercent);
}

TEST_CASE("compare: labels in slabs, wherever they are cut", "[compare]") {
  std::mt19937 random(6);
  for (int i = 0; i < 8; ++i) {
    const CoordBBox box = cube(10 + int(random() % 20), Coord(-3, 7, -13));
    const auto truth = mixedLabels(random, box, 9);
    const auto test = i == 0 ? Int32Grid::create(0) : mixedLabels(random, box, 5);
    if (i > 4) test->tree().voxelizeActiveTiles();
    for (int k = 0; k < 40; ++k)
      test->tree().setValueOff(Coord(-3 + int(random() % 9), 9, -13 + int(random() % 9)));
    const Comparison whole = compare(*truth, *test);
    const auto requireSame = [&](const LabelSlabs& a, const LabelSlabs& b) {
      const Comparison c = compare(a, b);
      REQUIRE(c.overlaps.size() == whole.overlaps.size());
      for (size_t k = 0; k < c.overlaps.size(); ++k) {
        REQUIRE(c.overlaps[k].truth == whole.overlaps[k].truth);
        REQUIRE(c.overlaps[k].test == whole.overlaps[k].test);
        REQUIRE(c.overlaps[k].voxels == whole.overlaps[k].voxels);
      }
      CHECK(c.variationOfInformation == whole.variationOfInformation);
      CHECK(c.adjustedRandIndex == whole.adjustedRandIndex);
    };
    requireSame(test::inSlabs(truth, {-16, -8, 0, 16, 24}), test::inSlabs(test, {-24, 0, 8, 24}));
    requireSame(singleSlab(truth), test::inSlabs(test, {-16, 0, 8, 16, 24}));
    requireSame(test::inSlabs(truth, {-16, 0, 24}), singleSlab(test));
    requireSame(singleSlab(truth), singleSlab(test));
  }
}

TEST_CASE("compare: stops when asked to", "[compare]") {
  Stop stop;
  CHECK_THROWS_AS(compare(*row({1}), *row({1}), &stop), Interrupted);
}
