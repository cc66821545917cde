// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

// What segment() and the stored graph make of the weights of unequal voxels.

#include <openvdb/Metadata.h>

#include "support/catch.h"
#include "support/random_case.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/segmentation/graph_metadata.h"
#include "vdb_madf/segmentation/remerge.h"
#include "vdb_madf/segmentation/segment.h"

using namespace vdb_madf;
using namespace vdb_madf::test;

TEST_CASE("segment_weights: taken from the mask's transform", "[segment_weights]") {
  for (uint64_t seed = 1; seed <= 20; ++seed) {
    RandomCase c = randomCase(seed, Coord(12, 11, 13));
    if (!c.domain) c.options.boundary = Boundary::closed;
    if (c.domain) ++c.domain->max().z();
    c.options.weights = VoxelWeights{25, 144, 25};
    const auto mask = maskOf(c);
    const Segmentation asked = segment(*mask, optionsOf(c));
    openvdb::Mat4d matrix = openvdb::Mat4d::identity();
    matrix.preScale(openvdb::Vec3d(0.0005, 0.0012, 0.0005));
    mask->setTransform(openvdb::math::Transform::createLinearTransform(matrix));
    c.options.weights.reset();
    const Segmentation found = segment(*mask, optionsOf(c));
    INFO(describe(c));
    REQUIRE(found.weights == VoxelWeights{25, 144, 25});
    REQUIRE(found.graph.weights == found.weights);
    REQUIRE(found.weightsError == 0);
    REQUIRE(found.graph.edges == asked.graph.edges);
    REQUIRE(found.graph.nodes == asked.graph.nodes);
    REQUIRE(found.grain->transform() == mask->transform());
    for (auto value = asked.grain->cbeginValueOn(); value; ++value)
      REQUIRE(found.grain->tree().getValue(value.getCoord()) == *value);
  }
}

TEST_CASE("segment_weights: refused are turned voxels, and what does not fit",
          "[segment_weights]") {
  const auto mask = toMask(fromPicture("##"));
  openvdb::Mat4d matrix = openvdb::Mat4d::identity();
  matrix.postRotate(openvdb::math::Z_AXIS, 0.5);
  mask->setTransform(openvdb::math::Transform::createLinearTransform(matrix));
  CHECK_THROWS_AS(segment(*mask), InvalidInput);
  CHECK_THROWS_AS(segment(*MaskGrid::create(*mask)), InvalidInput);
  SegmentOptions options;
  options.weights = VoxelWeights{};
  CHECK(segment(*mask, options).counts.grains >= 1);
  options.weights = VoxelWeights{1, 1, 1 << 30};
  CHECK_THROWS_AS(segment(*mask, options), InvalidInput);
  options.weights = VoxelWeights{1, 0, 1};
  CHECK_THROWS_AS(segment(*mask, options), InvalidInput);
  CHECK_THROWS_AS(segment(*MaskGrid::create(), options), InvalidInput);
}

TEST_CASE("segment_weights: the stored graph has those beside it", "[segment_weights]") {
  ManifoldGraph graph;
  graph.nodes = {{Coord(0), 25, 1}, {Coord(0, 0, 1000), 25, 1}};
  graph.weights = {25, 25, 144};
  const auto grid = Int32Grid::create();
  setGraph(*grid, graph);
  CHECK(storedGraph(*grid)->weights == graph.weights);
  CHECK(storedWeights(*grid) == graph.weights);
  setWeights(*grid, {25, 25, 144000});  // too much for nodes as far apart
  CHECK_THROWS_AS(storedGraph(*grid), InvalidInput);
  grid->insertMeta("madf_weights", openvdb::Vec3IMetadata({1, -1, 1}));
  CHECK_THROWS_AS(storedGraph(*grid), InvalidInput);
  CHECK_THROWS_AS(remerge(*grid), InvalidInput);
}
