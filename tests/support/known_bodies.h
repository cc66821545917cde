// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>

#include "support/random_volume.h"
#include "vdb_madf/grids/grid_types.h"

/// Label grids drawn from functions, and the directions and points to draw them at.
namespace vdb_madf::test {

using openvdb::Vec3d;

/// Labels over a box by labelOf(Vec3d); 0: none.
template <typename LabelOf>
Int32Grid::Ptr drawLabels(const CoordBBox& box, const LabelOf& labelOf) {
  auto grid = Int32Grid::create(0);
  auto accessor = grid->getAccessor();
  for (auto p = box.begin(); p; ++p)
    if (const int32_t label = labelOf((*p).asVec3d())) accessor.setValue(*p, label);
  return grid;
}

inline CoordBBox cubeAround(double halfEdge) {
  const int edge = int(std::ceil(halfEdge));
  return {Coord(-edge), Coord(edge)};
}

/// Uniform on the unit sphere.
inline Vec3d randomDirection(Rng& rng) {
  const double z = 2 * rng.unit() - 1, angle = 2 * M_PI * rng.unit();
  const double r = std::sqrt(std::max(0.0, 1 - z * z));
  return {r * std::cos(angle), r * std::sin(angle), z};
}

/// Uniform in the unit cube.
inline Vec3d randomPoint(Rng& rng) {
  const double x = rng.unit(), y = rng.unit();
  return {x, y, rng.unit()};
}

/// Two balls that overlap in a lens: their surfaces meet in a circle around the origin.
struct TwoBalls {
  Vec3d center;                    ///< of the circle
  Vec3d normal{1, 0, 0};           ///< from the first to the second ball
  double radius = 8;               ///< of the circle
  double first = 12, second = 12;  ///< of the balls, at least that of the circle

  double firstOffset() const { return std::sqrt(first * first - radius * radius); }
  double secondOffset() const { return std::sqrt(second * second - radius * radius); }
  double discArea() const { return M_PI * radius * radius; }
  CoordBBox box() const {
    return cubeAround(std::max(first + firstOffset(), second + secondOffset()) + 2);
  }
  /// 1 and 2, parted by the plane of the circle.
  int32_t operator()(const Vec3d& p) const {
    const Vec3d q = p - center;
    const double along = q.dot(normal);
    const Vec3d a = q + firstOffset() * normal, b = q - secondOffset() * normal;
    if (a.lengthSqr() >= first * first && b.lengthSqr() >= second * second) return 0;
    return along < 0 ? 1 : 2;
  }
};

/// The two balls near their disc alone: the rest of them has no part in its area.
inline Int32Grid::Ptr drawDisc(const TwoBalls& balls) {
  constexpr double kNear = 6, kAround = 12;
  const Vec3d &n = balls.normal, &c = balls.center;
  Coord corner;
  for (int i = 0; i < 3; ++i) {
    const double across = std::sqrt(std::max(0.0, 1 - n[i] * n[i]));
    corner[i] = int(std::ceil((balls.radius + kAround) * across + kNear * std::abs(n[i]))) + 1;
  }
  return drawLabels({Coord(0) - corner, corner}, [&](const Vec3d& p) {
    const double along = (p - c).dot(n);
    return std::abs(along) < kNear ? balls(p) : 0;
  });
}

/// Errors relative to the truth.
class Errors {
 public:
  void add(double measured, double truth) {
    const double error = std::abs(measured / truth - 1);
    sum_ += error;
    worst_ = std::max(worst_, error);
    ++count_;
  }
  double mean() const { return sum_ / count_; }
  double worst() const { return worst_; }
  int count() const { return count_; }

 private:
  double sum_ = 0, worst_ = 0;
  int count_ = 0;
};

/// Prints with VDB_MADF_PRINT_AREAS set: a row of the tables of lib/vdb_madf/measure/README.md.
inline void report(const std::string& what, const Errors& errors) {
  if (std::getenv("VDB_MADF_PRINT_AREAS"))
    std::printf("%-52s mean %.2f %%, worst %.2f %% of %d\n", what.c_str(), 100 * errors.mean(),
                100 * errors.worst(), errors.count());
}

}  // namespace vdb_madf::test
