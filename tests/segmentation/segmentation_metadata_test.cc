// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/segmentation/segmentation_metadata.h"

#include <openvdb/Metadata.h>

#include <array>
#include <limits>
#include <map>
#include <set>
#include <string>

#include "support/catch.h"
#include "support/edge_cases.h"
#include "support/oracle.h"
#include "support/random_case.h"
#include "vdb_madf/base/version.h"

namespace {

using namespace vdb_madf;
using namespace vdb_madf::test;
using openvdb::DoubleMetadata;
using openvdb::Int64Metadata;
using openvdb::StringMetadata;
using Texts = std::map<std::string, std::string>;

std::string word(MergeMode mode) {
  return std::array<const char*, 4>{"both", "angle", "neck", "score"}.at(size_t(mode));
}
std::string word(Adjacency adjacency) {
  return adjacency == Adjacency::manifold ? "manifold" : "cell";
}

/// All metadata of ours with their types, as text.
Texts storedTexts(const openvdb::MetaMap& metadata) {
  Texts result;
  for (auto entry = metadata.beginMeta(); entry != metadata.endMeta(); ++entry)
    if (entry->first.rfind("madf_", 0) == 0)
      result[entry->first] = entry->second->typeName() + " " + entry->second->str();
  return result;
}

std::string asText(const openvdb::Metadata& value) {
  return value.typeName() + " " + value.str();
}

/// What describeSegmentation() says, from its description.
Texts expectedTexts(const SegmentOptions& options, bool open, const SegmentCounts& counts,
                    int64_t fillHoles) {
  Texts texts = {
      {"madf_version", asText(StringMetadata(kVersion))},
      {"madf_gamma", asText(Int64Metadata(options.gamma))},
      {"madf_boundary", asText(StringMetadata(open ? "open" : "closed"))},
      {"madf_merge", asText(StringMetadata(word(options.merge.mode)))},
      {"madf_fill_holes", asText(Int64Metadata(fillHoles))},
      {"madf_tidy", asText(Int64Metadata(options.tidy))},
      {"madf_cavities", asText(Int64Metadata(counts.cavities))},
      {"madf_cavity_voxels", asText(Int64Metadata(counts.cavityVoxels))},
      {"madf_object_voxels", asText(Int64Metadata(counts.objectVoxels))},
      {"madf_medial_balls", asText(Int64Metadata(counts.medialBalls))},
      {"madf_kept_balls", asText(Int64Metadata(counts.keptBalls))},
      {"madf_critical_points", asText(Int64Metadata(counts.criticalPoints))},
      {"madf_grains", asText(Int64Metadata(counts.grains))},
      {"madf_largest_squared_distance", asText(Int64Metadata(counts.largestSquaredDistance))},
      {"madf_leaves", asText(Int64Metadata(counts.leaves))}};
  if (options.merge.minGrain > 0)
    texts["madf_min_grain"] = asText(Int64Metadata(options.merge.minGrain));
  if (options.merge.mode == MergeMode::score) {
    texts["madf_strictness"] = asText(DoubleMetadata(options.merge.strictness));
    return texts;
  }
  texts["madf_theta"] = asText(DoubleMetadata(options.merge.theta));
  texts["madf_adjacency"] = asText(StringMetadata(word(options.merge.adjacency)));
  texts["madf_delta"] = asText(Int64Metadata(options.merge.delta));
  return texts;
}

/// A different number in each place.
Segmentation numbered(int64_t first) {
  Segmentation s;
  s.counts = {first,     first + 1, first + 2, first + 3, first + 4,
              first + 5, first + 6, first + 7, first + 8};
  s.fillHoles = first + 9;
  return s;
}

}  // namespace

TEST_CASE("segmentation_metadata: every option and count has its key", "[segmentation_metadata]") {
  // Beyond 32 bits; the second description replaces the first.
  const auto grid = Int32Grid::create();
  for (const int64_t first : {int64_t(1), int64_t(10000000000)})
    for (const MergeMode mode :
         {MergeMode::both, MergeMode::score, MergeMode::angle, MergeMode::neck})
      for (const Adjacency adjacency : {Adjacency::manifold, Adjacency::cell})
        for (const bool open : {false, true}) {
          Segmentation s = numbered(first);
          s.open = open;
          SegmentOptions options;
          options.gamma = first + 10;
          s.tidy = options.tidy = 11;
          // What was used counts, not what was asked for.
          options.boundary = open ? Boundary::automatic : Boundary::open;
          options.merge = {mode, 10.75, -0.1234567890123, 12, adjacency};
          describeSegmentation(*grid, options, s);
          CHECK(storedTexts(*grid) == expectedTexts(options, open, s.counts, s.fillHoles));
          if (mode != MergeMode::score)
            CHECK(grid->metaValue<double>("madf_theta") == -0.1234567890123);
        }
}

TEST_CASE("segmentation_metadata: how manifolds were merged is read again",
          "[segmentation_metadata]") {
  const auto grid = Int32Grid::create();
  CHECK_FALSE(storedMerging(*grid));
  for (const MergeMode mode : {MergeMode::both, MergeMode::angle, MergeMode::neck})
    for (const Adjacency adjacency : {Adjacency::manifold, Adjacency::cell}) {
      describeMerging(*grid, {mode, 11, -0.1234567890123, 12, adjacency}, 6, 77);
      const auto merging = storedMerging(*grid);
      REQUIRE(merging);
      CHECK(merging->options.theta == -0.1234567890123);
      CHECK(merging->options.mode == mode);
      CHECK(merging->options.adjacency == adjacency);
      CHECK(merging->options.delta == 12);
      CHECK(merging->tidy == 6);
    }
  grid->insertMeta("madf_adjacency", StringMetadata("face"));
  CHECK_FALSE(storedMerging(*grid));
  describeMerging(*grid, {MergeMode::score, 10.75, -0.5, 12, Adjacency::cell, 27}, 6, 77);
  REQUIRE(storedMerging(*grid));
  CHECK(storedMerging(*grid)->options.minGrain == 27);
  CHECK(storedMerging(*grid)->options.mode == MergeMode::score);
  CHECK(storedMerging(*grid)->options.strictness == 10.75);
  CHECK(storedMerging(*grid)->tidy == 6);
  grid->removeMeta("madf_strictness");
  CHECK_FALSE(storedMerging(*grid));
  describeOwnMerging(*grid, 2, 5);
  CHECK_FALSE(storedMerging(*grid));
  CHECK_FALSE((*grid)["madf_min_grain"]);
}

TEST_CASE("segmentation_metadata: another merging changes what it is told by",
          "[segmentation_metadata]") {
  const auto grid = Int32Grid::create();
  grid->insertMeta("madf_source", StringMetadata("scan.tif"));
  const Segmentation s = numbered(100);
  describeSegmentation(*grid, {}, s);
  Texts expected = storedTexts(*grid);
  describeMerging(*grid, {MergeMode::angle, 11, 0.25, 5, Adjacency::cell}, 6, 77);
  CHECK(expected.count("madf_min_grain") == 0);
  expected.erase("madf_strictness");
  expected["madf_theta"] = asText(DoubleMetadata(0.25));
  expected["madf_merge"] = asText(StringMetadata("angle"));
  expected["madf_adjacency"] = asText(StringMetadata("cell"));
  expected["madf_delta"] = asText(Int64Metadata(5));
  expected["madf_tidy"] = asText(Int64Metadata(6));
  expected["madf_grains"] = asText(Int64Metadata(77));
  CHECK(storedTexts(*grid) == expected);
}

TEST_CASE("segmentation_metadata: the boundary comes back", "[segmentation_metadata]") {
  const auto grid = Int32Grid::create();
  CHECK(storedBoundary(*grid) == Boundary::automatic);
  for (const Boundary boundary :
       {Boundary::open, Boundary::closed, Boundary::automatic, Boundary::closed, Boundary::open}) {
    setBoundary(*grid, boundary);
    CHECK(storedBoundary(*grid) == boundary);
    CHECK(grid->metaCount() == (boundary == Boundary::automatic ? 0 : 1));
  }
}

TEST_CASE("segmentation_metadata: the number of grains comes back", "[segmentation_metadata]") {
  const auto grid = Int32Grid::create();
  CHECK_FALSE(grainCount(*grid).has_value());
  for (const int64_t grains : {int64_t(0), int64_t(5), std::numeric_limits<int64_t>::max()}) {
    describeMerging(*grid, {}, 0, grains);
    CHECK(grainCount(*grid).value() == grains);
  }
}

TEST_CASE("segmentation_metadata: names", "[segmentation_metadata]") {
  for (const MergeMode mode : {MergeMode::both, MergeMode::angle, MergeMode::neck})
    CHECK(toString(mode) == word(mode));
  for (const Adjacency adjacency : {Adjacency::manifold, Adjacency::cell})
    CHECK(toString(adjacency) == word(adjacency));
}

TEST_CASE("segmentation_metadata: a segmentation describes itself on each of its grids",
          "[segmentation_metadata]") {
  std::set<std::string> seen;
  const auto requireDescribed = [&](const RandomCase& c) {
    INFO(describe(c));
    OracleResult expected;
    try {
      expected = oracleSegment(c.object, c.domain, c.options);
    } catch (const Undefined&) {
      return;
    }
    const Segmentation s = segment(*maskOf(c), optionsOf(c));
    const Texts texts = expectedTexts(c.options, expected.open, expected.counts,
                                      oracleFillHoles(c.options, c.domain));
    for (const auto& grid : {s.grain, s.distanceSquared, s.power, s.manifold}) {
      const Texts found = storedTexts(*grid);
      CAPTURE(grid->getName());
      for (const auto& [key, value] : texts) {
        REQUIRE(found.count(key) == 1);
        REQUIRE(found.at(key) == value);
        seen.insert(key + value);
      }
      const VoxelWeights weights = c.options.weights.value_or(VoxelWeights{});
      REQUIRE(storedWeights(*grid) == weights);
      REQUIRE(bool((*grid)["madf_weights"]) == (weights != VoxelWeights{}));
      REQUIRE(grainCount(*grid).value() == expected.counts.grains);
      REQUIRE((storedBoundary(*grid) == Boundary::open) == expected.open);
    }
  };
  for (uint64_t seed = 1; seed <= 108; ++seed)
    requireDescribed(randomCase(seed, Coord(int(seed % 11) + 1)));
  for (const EdgeCase& edge : edgeCases()) {
    RandomCase c;
    c.object = edge.object;
    c.tiles = edge.tiles;
    c.options.gamma = 3;
    requireDescribed(c);
  }
  CHECK(seen.size() > 100);
}
