// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include <openvdb/math/Transform.h>

#include <string>

#include "support/catch.h"
#include "support/temporary_folder.h"
#include "support/vdb_files.h"
#include "vdb_madf/segmentation/initialize.h"
#include "vdb_madf/vdb/read_vdb.h"

using namespace vdb_madf;
using namespace vdb_madf::test;
using openvdb::Vec3d;
using openvdb::math::Mat4d;
using openvdb::math::Transform;

namespace {

Int32Grid::Ptr gridOf(const Transform::Ptr& transform) {
  const auto grid = Int32Grid::create();
  grid->tree().setValue(Coord(1, 2, 3), 4);
  grid->setTransform(transform);
  grid->setName("grain");
  return grid;
}

Transform::Ptr scaled(const Vec3d& edges) {
  const auto transform = Transform::createLinearTransform();
  transform->preScale(edges);
  return transform;
}

Transform::Ptr turned(double angle) {
  const auto transform = Transform::createLinearTransform(0.5);
  transform->preRotate(angle, openvdb::math::Z_AXIS);
  return transform;
}

Transform::Ptr sheared() {
  Mat4d matrix = Mat4d::identity();
  matrix(1, 0) = 0.1;
  return Transform::createLinearTransform(matrix);
}

Transform::Ptr frustum() {
  return Transform::createFrustumTransform(openvdb::BBoxd(Vec3d(0), Vec3d(100)), 0.3, 10, 0.1);
}

/// The error of reading a grid with this transform; empty if it can be read.
std::string errorWith(const Transform::Ptr& transform, const VdbReadOptions& options = {}) {
  initialize();
  const TemporaryFolder folder;
  const std::string path = folder.file("grid.vdb");
  writeWithOpenVdb(path, {gridOf(transform)});
  const std::string error = errorOf(path, options);
  if (!error.empty()) requireOneLineNaming(error, path);
  return error;
}

}  // namespace

TEST_CASE("vdb_file: voxels that are no boxes along the axes are refused", "[vdb_file]") {
  for (const auto& transform : {turned(0.01), turned(1.5707963267948966), sheared(), frustum()}) {
    const std::string error = errorWith(transform);
    CHECK_THAT(error, vdb_madf::test::Contains("'grain'"));
    CHECK_THAT(error, vdb_madf::test::Contains("resample it to voxels along the axes"));
    VdbReadOptions any;
    any.anyVoxelShape = true;
    CHECK(errorWith(transform, any) == "");
  }
}

TEST_CASE("vdb_file: boxes are read wherever they lie, mirrored too", "[vdb_file]") {
  const auto moved = Transform::createLinearTransform(0.0085);
  moved->postTranslate(Vec3d(1e4, -1e4, 0.5));
  for (const auto& transform :
       {scaled({1, 1, 1}), scaled({1, 1.0005, 1}), scaled({2, -2, 2}), scaled(Vec3d(1e-4)), moved,
        scaled({1, 1, 2}), scaled({0.01, -0.025, 0.5})})
    CHECK(errorWith(transform) == "");
}

TEST_CASE("vdb_file: the shape of voxels counts in grids that are wanted", "[vdb_file]") {
  initialize();
  const TemporaryFolder folder;
  const std::string path = folder.file("two.vdb");
  const auto other = gridOf(sheared());
  other->setName("other");
  writeWithOpenVdb(path, {other, gridOf(scaled({1, 1, 1}))});
  CHECK_THAT(errorOf(path), vdb_madf::test::Contains("'other'"));
  CHECK(readVdbHeaders(path).size() == 2);
  VdbReadOptions options;
  options.wanted = [](const openvdb::GridBase& grid) { return grid.getName() == "grain"; };
  CHECK(readVdb(path, options).size() == 1);
}
