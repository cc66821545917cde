// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

// A round core of a homogeneous sample tells of it what the whole block tells.

#include <algorithm>
#include <cmath>

#include "support/catch.h"
#include "vdb_madf/grids/grid_metadata.h"
#include "vdb_madf/measure/measure.h"
#include "vdb_madf/samples/snow.h"
#include "vdb_madf/segmentation/segment.h"

namespace {

using namespace vdb_madf;

/// The largest cylinder along z in a box.
Domain largestCore(const CoordBBox& box) {
  const openvdb::Vec3d center = box.getCenter();
  const double radius = box.dim().x() / 2.0;
  MaskTree tree(false);
  for (auto p = box.begin(); p; ++p) {
    const openvdb::Vec3d d = (*p).asVec3d() - center;
    if (std::hypot(d[0], d[1]) < radius) tree.setValueOn(*p);
  }
  return Domain(tree);
}

MaskGrid::Ptr cut(const MaskGrid& object, const Domain& domain) {
  const MaskGrid::Ptr result = object.deepCopy();
  result->tree().topologyIntersection(*domain.region());
  setDomain(*result, domain);
  return result;
}

/// Diameter that grains of so much of the volume do not exceed, of those that lie wholly within.
double innerDiameter(const Measurements& measured, double share) {
  std::vector<GrainMeasures> inner;
  for (const GrainMeasures& grain : measured.grains)
    if (!grain.atDomainFace) inner.push_back(grain);
  REQUIRE(inner.size() > 200);
  return diameterPercentile(inner, share, true);
}

}  // namespace

TEST_CASE("round_core: a core tells what the block does", "[round_core]") {
  SnowOptions options;
  options.size = Coord(144);
  options.length = 14;
  const MaskGrid::Ptr block = generateSnow(options).object;
  const Domain core = largestCore(storedDomain(*block)->box());
  const Measurements whole = measure(segment(*block)), round = measure(segment(*cut(*block, core)));
  const SampleMeasures &a = whole.sample, &b = round.sample;

  CHECK(b.regionVoxels == int64_t(core.voxelCount()));
  CHECK(b.objectFraction == Approx(a.objectFraction).epsilon(0.005));
  CHECK(b.specificSurface == Approx(a.specificSurface).epsilon(0.02));
  for (size_t axis = 0; axis < 3; ++axis)
    CHECK(b.correlationLengths[axis].value() ==
          Approx(a.correlationLengths[axis].value()).epsilon(0.03));
  for (const double share : {0.25, 0.5, 0.75})
    CHECK(innerDiameter(round, share) == Approx(innerDiameter(whole, share)).epsilon(0.03));
}
