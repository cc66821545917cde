// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/method/voxel_weights.h"

#include <openvdb/Metadata.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "support/catch.h"
#include "vdb_madf/base/errors.h"

namespace {

using namespace vdb_madf;
using namespace vdb_madf::test;
using EdgeLengths = std::array<double, 3>;

constexpr VoxelWeights kUnitWeights;
const Coord kExtent(300);

VoxelWeights exactly(const EdgeLengths& edges, const Coord& extent = kExtent) {
  const WeightsOfEdges found = weightsOfEdges(edges, extent);
  CHECK(found.error == 0);
  return found.weights;
}

/// max |w_a s_q / (w_q s_a) - 1|, s the squared edges, q the shortest one.
double errorOf(const VoxelWeights& w, const EdgeLengths& edges) {
  const int q = int(std::min_element(edges.begin(), edges.end()) - edges.begin());
  double error = 0;
  for (int a = 0; a < 3; ++a) {
    const long double ratio = (long double)edges[size_t(a)] / edges[size_t(q)];
    error = std::max(error, double(std::abs(w[a] / (w[q] * ratio * ratio) - 1)));
  }
  return error;
}

openvdb::math::Transform transformOf(const openvdb::Mat4d& matrix) {
  return *openvdb::math::Transform::createLinearTransform(matrix);
}

}  // namespace

TEST_CASE("voxel_weights: cubes weigh the same", "[voxel_weights]") {
  for (const double edge : {1.0, 0.005, 3e-9, 1e9, std::sqrt(2)}) {
    CHECK(exactly({edge, edge, edge}) == kUnitWeights);
    CHECK(exactly({edge, edge * 1.0009, edge}) == kUnitWeights);
    CHECK(exactly({edge, edge, edge}, Coord(26754)) == kUnitWeights);
  }
  CHECK(exactly({1, 1, 1.002}, Coord(20)) == VoxelWeights{250000, 250000, 251001});
}

TEST_CASE("voxel_weights: decimal edges have exact weights, in any unit", "[voxel_weights]") {
  for (const double unit : {1.0, 1e-3, 1e-6, 1e3, 1e-9, 1e12}) {
    CAPTURE(unit);
    CHECK(exactly({0.5 * unit, 0.5 * unit, 1.2 * unit}) == VoxelWeights{25, 25, 144});
    CHECK(exactly({1.2 * unit, 0.5 * unit, 0.5 * unit}) == VoxelWeights{144, 25, 25});
    CHECK(exactly({1 * unit, 2 * unit, 3 * unit}) == VoxelWeights{1, 4, 9});
    CHECK(exactly({20 * unit, 10 * unit, 10 * unit}) == VoxelWeights{4, 1, 1});
    CHECK(exactly({1 * unit, 1 * unit, 20 * unit}) == VoxelWeights{1, 1, 400});
    CHECK(exactly({0.1 * unit, 0.25 * unit, 0.7 * unit}) == VoxelWeights{4, 25, 196});
    CHECK(exactly({0.3 / 3 * unit, 0.1 * unit, 0.3 * unit}) == VoxelWeights{1, 1, 9});
  }
  CHECK(exactly({0.123, 0.124, 0.125}, Coord(100)) == VoxelWeights{15129, 15376, 15625});
}

TEST_CASE("voxel_weights: other edges get the smallest weights that are close", "[voxel_weights]") {
  // Read as 32-bit floats.
  const EdgeLengths floats = {double(0.1f), double(0.1f), double(0.3f)};
  const WeightsOfEdges found = weightsOfEdges(floats, kExtent);
  CHECK(found.weights == VoxelWeights{1, 1, 9});
  CHECK(found.error > 0);
  CHECK(found.error < 1e-6);
  CHECK(weightsOfEdges({1, std::sqrt(2), std::sqrt(3)}, kExtent).weights == VoxelWeights{1, 2, 3});

  const EdgeLengths edges = {1, std::cbrt(3), std::sqrt(M_PI)};
  for (const int size : {1, 10, 40, 150, 600, 2400}) {
    const WeightsOfEdges w = weightsOfEdges(edges, Coord(size));
    CAPTURE(size, w.weights.toString(), w.error);
    CHECK(fitWeights(w.weights, Coord(size)));
    CHECK(w.error == Approx(errorOf(w.weights, edges)).epsilon(1e-6));
    CHECK(w.error < 0.01);
    // The nearest integers for each smaller weight of the shortest edge are worse.
    for (int q = 1; q < w.weights.x; ++q) {
      const VoxelWeights other{q, int(std::lround(q * edges[1] * edges[1])),
                               int(std::lround(q * edges[2] * edges[2]))};
      REQUIRE(errorOf(other, edges) > std::max(w.error * 0.999999, 1e-6 * 0.999999));
    }
    if (size <= 40) CHECK(w.error <= 1e-6);
  }
}

TEST_CASE("voxel_weights: exact ones that do not fit give way", "[voxel_weights]") {
  const EdgeLengths edges = {0.1234, 0.1999, 0.5001};
  const WeightsOfEdges found = weightsOfEdges(edges, Coord(2000));
  CHECK(found.error > 0);
  CHECK(found.error < 0.005);
  CHECK(fitWeights(found.weights, Coord(2000)));
}

TEST_CASE("voxel_weights: a bound keeps squared distances in 32 bits", "[voxel_weights]") {
  CHECK(fitWeights(kUnitWeights, Coord(26754)));
  // 2 * 225 + 2088 * 1014^2 is just below 2^31.
  CHECK(fitWeights({1, 2088, 1}, {1, 1000, 1}));
  CHECK_FALSE(fitWeights({1, 2089, 1}, {1, 1000, 1}));
  CHECK_FALSE(fitWeights({1, 2088, 1}, {1, 1001, 1}));
  CHECK_THROWS_AS(checkWeights({1, 2089, 1}, {1, 1000, 1}), InvalidInput);
  for (const VoxelWeights& weights :
       {VoxelWeights{0, 1, 1}, VoxelWeights{1, -4, 1}, VoxelWeights{1, 1, 0}})
    CHECK_THROWS_AS(checkWeights(weights, Coord(1)), InvalidInput);
}

TEST_CASE("voxel_weights: edges that no weights fit are refused", "[voxel_weights]") {
  CHECK_THROWS_WITH(
      weightsOfEdges({1, 1, 5000}, Coord(300)),
      vdb_madf::test::Contains("1 x 1 x 5000") && vdb_madf::test::Contains("32 bits"));
  CHECK_THROWS_AS(weightsOfEdges({1e-300, 1, 1e300}, Coord(1)), InvalidInput);
  CHECK_THROWS_AS(weightsOfEdges({1, 1.5, 1}, Coord(26000)), InvalidInput);
  const double inf = std::numeric_limits<double>::infinity();
  for (const double edge : {0.0, -1.0, inf, std::nan("")})
    for (size_t axis = 0; axis < 3; ++axis) {
      EdgeLengths edges = {1, 2, 3};
      edges[axis] = edge;
      CHECK_THROWS_AS(weightsOfEdges(edges, Coord(1)), InvalidInput);
    }
}

TEST_CASE("voxel_weights: edges of a transform", "[voxel_weights]") {
  openvdb::Mat4d matrix = openvdb::Mat4d::identity();
  matrix.preScale(openvdb::Vec3d(0.0005, -0.0005, 0.0012));
  CHECK(voxelEdges(transformOf(matrix)) == EdgeLengths{0.0005, 0.0005, 0.0012});
  // OpenVDB takes the scale of a translated transform from differences of positions.
  matrix.postTranslate(openvdb::Vec3d(1e3, -77.7, 1e5));
  const WeightsOfEdges found = weightsOfEdges(voxelEdges(transformOf(matrix)), kExtent);
  CHECK(found.weights == VoxelWeights{25, 25, 144});
  CHECK(found.error < 1e-6);
  CHECK(voxelEdges(openvdb::math::Transform()) == EdgeLengths{1, 1, 1});
  matrix.postRotate(openvdb::math::Z_AXIS, 0.1);
  CHECK_THROWS_AS(voxelEdges(transformOf(matrix)), InvalidInput);
  matrix = openvdb::Mat4d::identity();
  matrix.preShear(openvdb::math::X_AXIS, openvdb::math::Y_AXIS, 0.3);
  CHECK_THROWS_AS(voxelEdges(transformOf(matrix)), InvalidInput);
}

TEST_CASE("voxel_weights: stored unless they are those of cubes", "[voxel_weights]") {
  openvdb::MetaMap metadata;
  CHECK(storedWeights(metadata) == kUnitWeights);
  setWeights(metadata, {25, 25, 144});
  CHECK(storedWeights(metadata) == VoxelWeights{25, 25, 144});
  setWeights(metadata, kUnitWeights);
  CHECK(metadata.metaCount() == 0);
  metadata.insertMeta("madf_weights", openvdb::Vec3IMetadata({1, 0, 1}));
  CHECK_THROWS_AS(storedWeights(metadata), InvalidInput);
}
