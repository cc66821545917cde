// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/segmentation/parameter_sweep.h"

#include <tbb/global_control.h>

#include <algorithm>
#include <map>

#include "support/catch.h"
#include "support/random_volume.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/grids/grid_metadata.h"
#include "vdb_madf/segmentation/initialize.h"
#include "vdb_madf/segmentation/segment.h"

using namespace vdb_madf;

namespace {

/// Balls with noise near their surface, in a domain.
MaskGrid::Ptr rough() {
  const CoordBBox box(Coord(0), Coord(55, 47, 51));
  test::Rng rng(1);
  const MaskGrid::Ptr object =
      test::toMask(test::randomVolume(test::VolumeKind::roughBalls, box, rng));
  setDomain(*object, box);
  return object;
}

SweepOptions wide() {
  SweepOptions options;
  options.gammas = {12, 0};
  options.modes = {MergeMode::neck, MergeMode::both, MergeMode::angle};
  options.thetas = {-0.5, -1, -0.85};
  options.deltas = {4, 0};
  options.tidy = 1;
  options.smallVoxels = 40;
  return options;
}

/// From the voxels of the labels of a fresh segmentation.
void requireRow(const SweepRow& row, const MaskGrid& object, const SweepOptions& options) {
  CAPTURE(row.gamma, int(row.mode), row.theta, row.delta);
  SegmentOptions one;
  one.gamma = row.gamma;
  one.merge = {row.mode, row.strictness, row.theta, row.delta, options.adjacency, options.minGrain};
  one.tidy = options.tidy;
  one.boundary = options.boundary;
  const Segmentation segmentation = segment(object, one);
  std::map<int32_t, int64_t> voxels;
  for (auto voxel = segmentation.grain->cbeginValueOn(); voxel; ++voxel) ++voxels[*voxel];
  std::vector<int64_t> sizes;
  int64_t small = 0, inSmall = 0, all = 0;
  for (const auto& [label, size] : voxels) {
    sizes.push_back(size);
    all += size;
    if (size < options.smallVoxels) {
      ++small;
      inSmall += size;
    }
  }
  std::sort(sizes.begin(), sizes.end());
  const size_t n = sizes.size();
  CHECK(row.grains == int64_t(n));
  CHECK(row.medianVoxels == double(sizes[n / 2] + sizes[(n - 1) / 2]) / 2);
  CHECK(row.smallGrains == small);
  CHECK(row.smallVoxels == inSmall);
  CHECK(row.largestVoxels == sizes.back());
  CHECK(row.objectVoxels == all);
  CHECK(row.flaws.crumbs == segmentation.flaws.crumbs);
  CHECK(row.flaws.slivers == segmentation.flaws.slivers);
  CHECK(row.flaws.inPieces == segmentation.flaws.inPieces);
}

bool equalRows(const SweepRow& a, const SweepRow& b) {
  return a.gamma == b.gamma && a.mode == b.mode && a.theta == b.theta && a.delta == b.delta &&
         a.grains == b.grains && a.flaws.crumbs == b.flaws.crumbs &&
         a.medianVoxels == b.medianVoxels && a.smallGrains == b.smallGrains &&
         a.smallVoxels == b.smallVoxels && a.largestVoxels == b.largestVoxels &&
         a.objectVoxels == b.objectVoxels && a.strictness == b.strictness;
}

}  // namespace

TEST_CASE("parameter_sweep: each row is what a segmentation with its options gives",
          "[parameter_sweep]") {
  const MaskGrid::Ptr object = rough();
  SweepOptions options = wide();
  for (const Adjacency adjacency : {Adjacency::manifold, Adjacency::cell}) {
    options.adjacency = adjacency;
    const std::vector<SweepRow> rows = parameterSweep(*object, options);
    REQUIRE(rows.size() == 36);
    for (const SweepRow& row : rows) requireRow(row, *object, options);
    // Rough surfaces: the choices do matter here.
    CHECK(rows[0].grains <= rows[1].grains);
    CHECK(rows.back().grains > rows[0].grains);
  }
}

TEST_CASE("parameter_sweep: rows by score have a strictness, and no theta and delta",
          "[parameter_sweep]") {
  initialize();
  const MaskGrid::Ptr object = rough();
  SweepOptions options = wide();
  options.modes = {MergeMode::score, MergeMode::both};
  options.strictnesses = {11, 40, -40};
  const std::vector<SweepRow> rows = parameterSweep(*object, options);
  REQUIRE(rows.size() == 2 * (3 + 6));
  for (const SweepRow& row : rows) requireRow(row, *object, options);
  for (size_t i = 0; i < 3; ++i) {
    CHECK(rows[i].mode == MergeMode::score);
    CHECK(rows[i].strictness == options.strictnesses[i]);
    CHECK(rows[3 + i].mode == MergeMode::both);
  }
  CHECK(rows[2].grains < rows[0].grains);
  CHECK(rows[0].grains <= rows[1].grains);
  options.minGrain = 100000;
  const std::vector<SweepRow> joined = parameterSweep(*object, options);
  for (const SweepRow& row : joined) requireRow(row, *object, options);
  CHECK(joined[1].grains < rows[1].grains);
  CHECK(joined[3].grains < rows[3].grains);
  options.minGrain = -1;
  CHECK_THROWS_AS(parameterSweep(*object, options), InvalidInput);
  options.minGrain = 0;
  options.strictnesses = {};
  CHECK_THROWS_AS(parameterSweep(*object, options), InvalidInput);
  options.strictnesses = {11, 1e9};
  CHECK_THROWS_AS(parameterSweep(*object, options), InvalidInput);
}

TEST_CASE("parameter_sweep: rows come by gamma, mode, delta and theta, as asked for",
          "[parameter_sweep]") {
  const SweepOptions options = wide();
  const std::vector<SweepRow> rows = parameterSweep(*rough(), options);
  size_t i = 0;
  for (const int64_t gamma : options.gammas)
    for (const MergeMode mode : options.modes)
      for (const int delta : options.deltas)
        for (const double theta : options.thetas) {
          CHECK(rows[i].gamma == gamma);
          CHECK(rows[i].mode == mode);
          CHECK(rows[i].delta == delta);
          CHECK(rows[i++].theta == theta);
        }
}

TEST_CASE("parameter_sweep: a larger theta merges more", "[parameter_sweep]") {
  SweepOptions options;
  options.modes = {MergeMode::angle, MergeMode::neck};
  options.thetas.clear();
  for (int i = 0; i <= 10; ++i) options.thetas.push_back(-1 + 0.1 * i);
  const std::vector<SweepRow> rows = parameterSweep(*rough(), options);
  for (size_t i = 1; i < rows.size(); ++i)
    if (rows[i].mode == rows[i - 1].mode) CHECK(rows[i].grains <= rows[i - 1].grains);
}

TEST_CASE("parameter_sweep: the boundary and the domain are heeded", "[parameter_sweep]") {
  const MaskGrid::Ptr object = rough();
  SweepOptions options;
  options.modes = {MergeMode::angle};
  options.boundary = Boundary::closed;
  const SweepRow closed = parameterSweep(*object, options)[0];
  requireRow(closed, *object, options);
  options.boundary = Boundary::open;
  const SweepRow open = parameterSweep(*object, options)[0];
  requireRow(open, *object, options);
  CHECK(open.grains != closed.grains);
}

TEST_CASE("parameter_sweep: unequal voxels are measured as they are", "[parameter_sweep]") {
  const MaskGrid::Ptr object = rough();
  SweepOptions options;
  options.modes = {MergeMode::score, MergeMode::both};
  options.thetas = {-0.9, -0.5};
  options.deltas = {8};
  const SweepRow cubes = parameterSweep(*object, options)[0];
  openvdb::Mat4d matrix = openvdb::Mat4d::identity();
  matrix.preScale(openvdb::Vec3d(0.5, 0.5, 1.2));
  object->setTransform(openvdb::math::Transform::createLinearTransform(matrix));
  const std::vector<SweepRow> rows = parameterSweep(*object, options);
  for (const SweepRow& row : rows) requireRow(row, *object, options);
  CHECK_FALSE(equalRows(rows[0], cubes));
}

TEST_CASE("parameter_sweep: nothing, and options out of range", "[parameter_sweep]") {
  const SweepRow none = parameterSweep(MaskGrid(), {})[0];
  CHECK(none.grains + none.smallGrains + none.largestVoxels + none.objectVoxels == 0);
  CHECK(none.medianVoxels == 0);
  const MaskGrid empty;
  SweepOptions options;
  options.gammas = {0, -1};
  CHECK_THROWS_AS(parameterSweep(empty, options), InvalidInput);
  options.gammas = {};
  CHECK_THROWS_AS(parameterSweep(empty, options), InvalidInput);
  options.gammas = {0};
  options.thetas = {-1.01};
  CHECK_THROWS_AS(parameterSweep(empty, options), InvalidInput);
  options.thetas = {-1};
  options.deltas = {2, 81};
  CHECK_THROWS_AS(parameterSweep(empty, options), InvalidInput);
}

TEST_CASE("parameter_sweep: threads do not matter", "[parameter_sweep]") {
  const MaskGrid::Ptr object = rough();
  const std::vector<SweepRow> parallel = parameterSweep(*object, wide());
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const std::vector<SweepRow> sequential = parameterSweep(*object, wide());
  CHECK(std::equal(parallel.begin(), parallel.end(), sequential.begin(), sequential.end(),
                   equalRows));
}

TEST_CASE("parameter_sweep: stored manifolds give the same rows", "[parameter_sweep]") {
  initialize();  // the graph is metadata
  const MaskGrid::Ptr object = rough();
  SweepOptions options = wide();
  options.gammas = {12};
  options.modes.push_back(MergeMode::score);
  options.strictnesses = {10, 11};
  SegmentOptions one;
  one.gamma = 12;
  one.keepManifold = true;
  const Segmentation segmentation = segment(*object, one);
  const std::vector<SweepRow> rows = mergingSweep(*segmentation.manifold, options),
                              fresh = parameterSweep(*object, options);
  REQUIRE(rows.size() == fresh.size());
  for (size_t i = 0; i < rows.size(); ++i) CHECK(equalRows(rows[i], fresh[i]));
  CHECK_THROWS_WITH(mergingSweep(*segmentation.grain, options),
                    vdb_madf::test::Contains("carries no graph of manifolds"));
}
