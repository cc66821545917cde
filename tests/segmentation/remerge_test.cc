// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/segmentation/remerge.h"

#include <openvdb/Metadata.h>

#include <cmath>
#include <map>
#include <string>
#include <vector>

#include "support/catch.h"
#include "support/edge_cases.h"
#include "support/oracle.h"
#include "support/random_case.h"
#include "support/runs.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/grids/grid_metadata.h"
#include "vdb_madf/segmentation/graph_metadata.h"

namespace {

using namespace vdb_madf;
using namespace vdb_madf::test;

/// Manifolds 1, 2 and 3 in a row of balls of D = 9, 4, 4: the first two meet in a wide neck, the
/// others in a narrow one, outside the cells of their critical points.
ManifoldGraph rowGraph() {
  ManifoldGraph graph;
  graph.nodes = {{{0, 0, 0}, 9, 2}, {{0, 0, 3}, 4, 2}, {{0, 0, 6}, 4, 3}};
  graph.edges = {{0, 1, 1, 4, true}, {1, 2, 1, 1, false}};
  return graph;
}

Int32Grid::Ptr rowGrid() {
  const auto grid = Int32Grid::create(0);
  grid->setName("manifold");
  const std::vector<int32_t> numbers = {1, 1, 2, 2, 3, 3, 3};
  for (int z = 0; z < 7; ++z) grid->tree().setValueOn(Coord(0, 0, z), numbers[size_t(z)]);
  setGraph(*grid, rowGraph());
  return grid;
}

std::vector<int32_t> labelsOfRow(const Int32Grid& grid) {
  std::vector<int32_t> values;
  for (int z = 0; z < 7; ++z) values.push_back(grid.tree().getValue(Coord(0, 0, z)));
  return values;
}

/// Names, types and values of all metadata.
std::map<std::string, std::string> texts(const openvdb::MetaMap& metadata) {
  std::map<std::string, std::string> result;
  for (auto entry = metadata.beginMeta(); entry != metadata.endMeta(); ++entry)
    result[entry->first] = entry->second->typeName() + " " + entry->second->str();
  return result;
}

const std::vector<MergeOptions> kMergings = {
    {MergeMode::both, 11, -1, 0, Adjacency::manifold},
    {MergeMode::both, 11, -0.9, 2, Adjacency::manifold},
    {MergeMode::angle, 11, -0.8, 0, Adjacency::manifold},
    {MergeMode::angle, 11, -0.8, 0, Adjacency::cell},
    {MergeMode::neck, 11, -0.6, 5, Adjacency::manifold},
    {MergeMode::both, 11, 1, 80, Adjacency::cell},
    {MergeMode::score, 8, -0.9, 2, Adjacency::manifold},
    {MergeMode::score, 11, -0.5, 2, Adjacency::manifold},
    {MergeMode::score, 11, -0.9, 2, Adjacency::manifold, 20},
    {MergeMode::both, 11, -1, 0, Adjacency::manifold, 99}};

/// Labels as the oracle merges its own manifolds, and all else as a fresh segmentation has it.
void requireFresh(RandomCase c) {
  INFO(describe(c));
  OracleResult oracle;
  try {
    oracle = oracleSegment(c.object, c.domain, c.options);
  } catch (const Undefined&) {
    return;
  }
  const Segmentation first = segment(*maskOf(c), optionsOf(c));
  for (const MergeOptions& merging : kMergings) {
    const int tidy = merging.theta < -0.7 ? 2 : 0;
    CAPTURE(merging.strictness, merging.theta, int(merging.mode), int(merging.adjacency),
            merging.minGrain, tidy);
    const Merging merged = oracleMerge(oracle.graph, merging);
    std::vector<Coord> representatives;
    for (const uint32_t node : merged.representative)
      representatives.push_back(oracle.graph.nodes[node].position);
    DenseVolume<int64_t> expected(c.object.box());
    for (int i = 0; i < c.object.size(); ++i)
      if (c.object[i])
        expected[i] = merged.grainOfNode[size_t(oracle.manifold[c.object.coord(i)] - 1)];
    const auto grain = remerge(*first.manifold, merging, tidy);
    REQUIRE(difference("grain", *grain, c.object,
                       oracleTidy(expected, representatives, tidy, oracle.graph.weights)) == "");
    c.options.merge = merging;
    c.options.tidy = tidy;
    const Segmentation fresh = segment(*maskOf(c), optionsOf(c));
    REQUIRE(texts(*grain) == texts(*fresh.grain));
    REQUIRE(grain->transform() == fresh.grain->transform());
  }
}

}  // namespace

TEST_CASE("remerge: a row, drawn by hand", "[remerge]") {
  const auto manifold = rowGrid();
  const auto labels = [&](double theta, MergeMode mode, Adjacency adjacency = Adjacency::manifold) {
    return labelsOfRow(*remerge(*manifold, {mode, 11, theta, 0, adjacency}, 0));
  };
  using Row = std::vector<int32_t>;
  // 4 >= (1 - theta)/2 * 4 for all theta; 1 >= (1 - theta)/2 * 4 from 0.5 on.
  CHECK(labels(-1, MergeMode::neck) == Row{1, 1, 1, 1, 2, 2, 2});
  CHECK(labels(0.49, MergeMode::neck) == Row{1, 1, 1, 1, 2, 2, 2});
  CHECK(labels(0.5, MergeMode::neck) == Row{1, 1, 1, 1, 1, 1, 1});
  // Cosines (9 - 9 - 4)/12 = -1/3 and (9 - 4 - 4)/8 = 1/8.
  CHECK(labels(-0.4, MergeMode::angle) == Row{1, 1, 2, 2, 3, 3, 3});
  CHECK(labels(-0.3, MergeMode::angle) == Row{1, 1, 1, 1, 2, 2, 2});
  CHECK(labels(0.13, MergeMode::angle) == Row{1, 1, 1, 1, 1, 1, 1});
  CHECK(labels(0.13, MergeMode::angle, Adjacency::cell) == Row{1, 1, 1, 1, 2, 2, 2});
}

TEST_CASE("remerge: leaves the manifolds as they are", "[remerge]") {
  const auto manifold = rowGrid();
  setVoxelSize(*manifold, VoxelSize{5e-6});
  manifold->insertMeta("madf_source", openvdb::StringMetadata("scan.tif"));
  manifold->insertMeta("madf_grains", openvdb::Int64Metadata(99));
  const auto before = texts(*manifold);
  const auto grain = remerge(*manifold, {MergeMode::neck, 11, 0.5, 3, Adjacency::cell}, 4);
  CHECK(labelsOfRow(*manifold) == std::vector<int32_t>{1, 1, 2, 2, 3, 3, 3});
  CHECK(texts(*manifold) == before);
  CHECK(storedGraph(*manifold)->nodes == rowGraph().nodes);
  CHECK_FALSE(storedGraph(*grain).has_value());
  CHECK(grain->getName() == "grain");
  CHECK(grain->transform() == manifold->transform());
  CHECK(grain->metaValue<std::string>("madf_source") == "scan.tif");
  CHECK(grain->metaValue<int64_t>("madf_grains") == 1);
  CHECK(grain->metaValue<double>("madf_theta") == 0.5);
  CHECK(grain->metaValue<std::string>("madf_merge") == "neck");
  CHECK(grain->metaValue<std::string>("madf_adjacency") == "cell");
  CHECK(grain->metaValue<int64_t>("madf_delta") == 3);
  CHECK(grain->metaValue<int64_t>("madf_tidy") == 4);
}

TEST_CASE("remerge: of edge cases, as a fresh segmentation", "[remerge]") {
  for (const EdgeCase& edge : edgeCases())
    for (const int64_t gamma : {0, 30}) {
      RandomCase c;
      c.object = edge.object;
      c.tiles = edge.tiles;
      c.options.gamma = gamma;
      requireFresh(c);
    }
}

TEST_CASE("remerge: as a fresh segmentation", "[remerge]") {
  for (uint64_t seed = 1; seed <= 108; ++seed) {
    Rng rng(seed);
    requireFresh(
        randomCase(seed, Coord(rng.between(1, 12), rng.between(1, 12), rng.between(1, 12))));
  }
}

TEST_CASE("remerge: takes active tiles", "[remerge]") {
  // As a pruned grid has them: 8^3 voxels of the first manifold, 128^3 of the second.
  const auto manifold = rowGrid();
  manifold->tree().addTile(1, Coord(-8, 0, 0), 1, true);
  manifold->tree().addTile(2, Coord(-128, 128, 0), 3, true);
  ManifoldGraph graph = rowGraph();
  graph.nodes[0].voxels += 512;
  graph.nodes[2].voxels += 128 * 128 * 128;
  setGraph(*manifold, graph);
  const auto grain = remerge(*manifold, {MergeMode::neck, 11, -1, 0, Adjacency::manifold}, 0);
  CHECK(grain->activeVoxelCount() == 7 + 512 + 128 * 128 * 128);
  for (const Coord& p : {Coord(-8, 0, 0), Coord(-1, 7, 7)}) CHECK(grain->tree().getValue(p) == 1);
  for (const Coord& p : {Coord(-128, 128, 0), Coord(-1, 255, 127)})
    CHECK(grain->tree().getValue(p) == 2);
  CHECK(grain->tree().getValue(Coord(-9, 0, 0)) == 0);
  CHECK(labelsOfRow(*grain) == std::vector<int32_t>{1, 1, 1, 1, 2, 2, 2});
}

TEST_CASE("remerge: a merging of one's own", "[remerge]") {
  const auto manifold = rowGrid();
  manifold->insertMeta("madf_source", openvdb::StringMetadata("scan.tif"));
  manifold->insertMeta("madf_theta", openvdb::DoubleMetadata(-0.9));
  const ManifoldGraph graph = storedGraph(*manifold).value();
  const auto ends = applyMerging(*manifold, mergeClasses(graph, {0, 1, 0}), 0);
  CHECK(labelsOfRow(*ends) == std::vector<int32_t>{1, 1, 2, 2, 1, 1, 1});
  CHECK(ends->getName() == "grain");
  CHECK(ends->metaValue<std::string>("madf_source") == "scan.tif");
  CHECK(ends->metaValue<std::string>("madf_merge") == "own");
  CHECK(ends->metaValue<int64_t>("madf_grains") == 2);
  CHECK(ends->metaValue<int64_t>("madf_tidy") == 0);
  CHECK_FALSE(storedGraph(*ends).has_value());
  for (const char* key : {"madf_theta", "madf_adjacency", "madf_delta"}) CHECK_FALSE((*ends)[key]);
  // What merge() says gives the labels of remerge(), tidied too.
  Rng rng(5);
  const ObjectVolume object =
      randomVolume(VolumeKind::roughBalls, boxAt({-3, -4, 10}, {30, 33, 27}), rng);
  SegmentOptions options;
  options.keepManifold = true;
  const auto result = segment(*toMask(object), options);
  const MergeOptions merging{MergeMode::both, 11, -0.7, 2, Adjacency::manifold};
  for (const int rounds : {0, 2}) {
    const auto expected = remerge(*result.manifold, merging, rounds),
               own = applyMerging(*result.manifold, merge(result.graph, merging), rounds);
    REQUIRE(own->activeVoxelCount() == expected->activeVoxelCount());
    for (auto voxel = expected->cbeginValueOn(); voxel; ++voxel)
      REQUIRE(own->tree().getValue(voxel.getCoord()) == *voxel);
  }
}

TEST_CASE("remerge: a merging that does not fit its graph is refused", "[remerge]") {
  const auto manifold = rowGrid();
  const Merging good{{1, 1, 2}, {0, 2}};
  CHECK_NOTHROW(applyMerging(*manifold, good, 0));
  CHECK_THROWS_AS(applyMerging(*manifold, good, -1), InvalidInput);
  for (const Merging& bad :
       {Merging{{1, 1}, {0}}, Merging{{1, 1, 2, 2}, {0, 2}}, Merging{{1, 1, 3}, {0, 2}},
        Merging{{1, 1, -1}, {0}}, Merging{{1, 1, 0}, {0}}, Merging{{1, 1, 2}, {2, 0}},
        Merging{{1, 1, 2}, {0, 3}}, Merging{{1, 1, 2}, {0, 2, 2}}})
    CHECK_THROWS_AS(applyMerging(*manifold, bad, 0), InvalidInput);
  ManifoldGraph graph = rowGraph();
  graph.nodes.push_back({{0, 0, 9}, 1, 0});  // in a cavity
  setGraph(*manifold, graph);
  CHECK_NOTHROW(applyMerging(*manifold, {{1, 1, 2, 0}, {0, 2}}, 0));
  CHECK_THROWS_AS(applyMerging(*manifold, {{1, 1, 2, 3}, {0, 2, 3}}, 0), InvalidInput);
  removeGraph(*manifold);
  CHECK_THROWS_AS(applyMerging(*manifold, good, 0), InvalidInput);
}

TEST_CASE("remerge: what does not fit is refused", "[remerge]") {
  const auto manifold = rowGrid();
  SECTION("no graph") {
    removeGraph(*manifold);
    CHECK_THROWS_AS(remerge(*manifold), InvalidInput);
  }
  SECTION("a number that the graph does not know") {
    for (const int32_t number : {0, -1, 4, 1000000}) {
      manifold->tree().setValueOn(Coord(50, 60, 70), number);
      CAPTURE(number);
      CHECK_THROWS_AS(remerge(*manifold), InvalidInput);
    }
    manifold->tree().setValueOff(Coord(50, 60, 70), 0);
    CHECK_NOTHROW(remerge(*manifold));
  }
  SECTION("theta") {
    for (const double theta : {-1.01, 1.01, std::nan("")})
      CHECK_THROWS_AS(remerge(*manifold, {MergeMode::both, 11, theta, 2, Adjacency::manifold}),
                      InvalidInput);
  }
  SECTION("delta and tidy") {
    for (const int delta : {-1, 81})
      CHECK_THROWS_AS(remerge(*manifold, {MergeMode::both, 11, -0.9, delta, Adjacency::manifold}),
                      InvalidInput);
    CHECK_THROWS_AS(remerge(*manifold, {}, -1), InvalidInput);
    CHECK_THROWS_AS(remerge(*manifold, {MergeMode::score, 11, -0.9, 2, Adjacency::manifold, -1}),
                    InvalidInput);
  }
  SECTION("more or fewer voxels of a manifold than its graph says") {
    manifold->tree().setValueOn(Coord(0, 0, 7), 3);
    CHECK_THROWS_AS(remerge(*manifold), InvalidInput);
    manifold->tree().setValueOff(Coord(0, 0, 7), 0);
    CHECK_NOTHROW(remerge(*manifold));
    manifold->tree().setValueOff(Coord(0, 0, 6), 0);
    CHECK_THROWS_AS(remerge(*manifold), InvalidInput);
  }
  SECTION("interrupted") {
    StopAtOnce stop;
    CHECK_THROWS_AS(remerge(*manifold, {}, 0, &stop), Interrupted);
  }
}

TEST_CASE("remerge: threads do not matter, nor where the grid lies", "[remerge]") {
  Rng rng(7);  // more leaves than one task takes
  const ObjectVolume object =
      randomVolume(VolumeKind::roughBalls, boxAt({-43, -40, 100}, {60, 53, 57}), rng);
  SegmentOptions options;
  options.keepManifold = true;
  const MergeOptions merging{MergeMode::both, 11, -0.7, 2, Adjacency::manifold};
  options.merge = merging;
  const auto expected = segment(*toMask(object), options).grain;
  DenseVolume<int64_t> labels(object.box());
  for (int i = 0; i < object.size(); ++i) labels[i] = expected->tree().getValue(object.coord(i));
  options.merge = {};
  for (int step = 0; step <= 4; ++step) {
    const ObjectVolume moved = translated(object, Coord(step, -step, 3 * step));
    const auto manifold = segment(*toMask(moved), options).manifold;
    DenseVolume<int64_t> there(moved.box());
    for (int i = 0; i < labels.size(); ++i) there[i] = labels[i];
    CAPTURE(step);
    for (const int threads : {1, 4}) {
      const auto grain = withThreads(threads, [&] { return remerge(*manifold, merging); });
      REQUIRE(difference("grain", *grain, moved, there) == "");
    }
  }
}
