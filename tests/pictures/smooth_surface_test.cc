// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/pictures/detail/smooth_surface.h"

#include <algorithm>
#include <cmath>
#include <random>

#include "support/catch.h"

using namespace vdb_madf;

namespace {

using Vec = openvdb::Vec3d;

MaskGrid::Ptr randomObject(unsigned seed, const CoordBBox& box, unsigned oneIn) {
  std::mt19937 random(seed);
  const auto object = MaskGrid::create();
  for (auto p = box.begin(); p; ++p)
    if (random() % oneIn == 0) object->tree().setValueOn(*p);
  return object;
}

double weightAt(double distance) {
  return std::abs(distance) < 4 ? (1 + std::cos(M_PI * distance / 4)) / 8 : 0;
}
double slopeAt(double distance) {
  return std::abs(distance) < 4 ? -M_PI / 32 * std::sin(M_PI * distance / 4) : 0;
}

/// By the definition, over all voxels.
detail::SmoothValue naiveValue(const MaskGrid& object, const Vec& point) {
  detail::SmoothValue result;
  for (auto voxel = object.cbeginValueOn(); voxel; ++voxel) {
    const Vec d = point - voxel.getCoord().asVec3d() - Vec(0.5);
    const Vec w(weightAt(d[0]), weightAt(d[1]), weightAt(d[2]));
    result.fill += w[0] * w[1] * w[2];
    result.gradient +=
        Vec(slopeAt(d[0]) * w[1] * w[2], w[0] * slopeAt(d[1]) * w[2], w[0] * w[1] * slopeAt(d[2]));
  }
  return result;
}

}  // namespace

TEST_CASE("smooth_surface: values are those of the definition, wherever one looked before",
          "[smooth_surface]") {
  const CoordBBox box(Coord(-13, 2, -20), Coord(9, 21, 3));
  std::mt19937 random(1);
  std::uniform_real_distribution<double> part(0, 1);
  for (const unsigned oneIn : {1u, 2u, 9u}) {
    const MaskGrid::Ptr object = randomObject(oneIn, box, oneIn);
    detail::SmoothSurface surface(*object);
    Vec point(0);
    for (int i = 0; i < 3000; ++i) {
      // Mostly a short step; now and then somewhere else, also outside.
      for (int axis = 0; axis < 3; ++axis)
        point[axis] = i % 10 == 0 ? box.min()[axis] - 6 + part(random) * 35
                                  : point[axis] + 0.4 * (part(random) - 0.5);
      if (i % 50 == 0) point = Vec(std::round(point[0]), std::round(point[1]) + 0.5, point[2]);
      const detail::SmoothValue value = surface.at(point), naive = naiveValue(*object, point);
      CAPTURE(oneIn, i, point);
      REQUIRE(std::abs(value.fill - naive.fill) < 1e-12);
      REQUIRE((value.gradient - naive.gradient).length() < 1e-12);
    }
  }
}
