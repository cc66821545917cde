// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/exports/detail/remesh.h"

#include <tbb/global_control.h>

#include <cmath>

#include "support/catch.h"
#include "support/label_shapes.h"
#include "support/mesh_checks.h"

using namespace vdb_madf;
using namespace vdb_madf::test;
using detail::remesh;

namespace {

/// A ball of radius 12.5 around (20, 20, 20), its mesh smoothed.
GrainMesh ballMesh() {
  LabelMap voxels;
  for (const Coord& p : CoordBBox(Coord(0), Coord(40)))
    if ((p - Coord(20)).asVec3d().length() < 12.5) voxels[p] = 7;
  GrainMeshOptions options;
  options.smoothing = 10;
  return grainMesh(*labelGrid(voxels), options);
}

}  // namespace

TEST_CASE("remesh: closed, outside out, near the surface, in facets of the size", "[remesh]") {
  const GrainMesh mesh = ballMesh();
  for (const double facet : {0.4, 1.0, 2.5, 8.0}) {
    const GrainMesh made = remesh(mesh, facet);
    CAPTURE(facet, made.triangles.size());
    CHECK(made.labels == std::vector<int32_t>{7});
    CHECK(whyNotClosed(made) == "");
    CHECK(meshVolumes(made)[0] == Approx(meshVolumes(mesh)[0]).epsilon(0.01 + facet * facet / 100));
    for (const openvdb::Vec3f& point : made.points)
      CHECK(std::abs((point - openvdb::Vec3f(20)).length() - 12.5) < 0.7 + facet / 4);
    // A quadrangle, two triangles, for each square of this side, and some more where it slants.
    const double squares = 4 * 3.14159 * 12.5 * 12.5 / (facet * facet);
    CHECK(double(made.triangles.size()) / 2 / squares > 0.75);
    CHECK(double(made.triangles.size()) / 2 / squares < 2.1);
  }
}

TEST_CASE("remesh: the same for any number of threads", "[remesh]") {
  const GrainMesh mesh = ballMesh(), made = remesh(mesh, 0.3);
  for (const size_t threads : {1, 2, 7}) {
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
    const GrainMesh again = remesh(mesh, 0.3);
    CHECK(again.points == made.points);
    CHECK(again.triangles == made.triangles);
  }
}
