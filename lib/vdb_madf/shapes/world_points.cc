// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/shapes/world_points.h"

#include <algorithm>
#include <numeric>
#include <tuple>

#include "vdb_madf/base/detail/parallel.h"

namespace vdb_madf {

namespace {

using openvdb::Vec3d;
using openvdb::Vec3f;

constexpr size_t kPointGrain = 1 << 14;
/// In voxels: the first is far above what 64 bits round, both are far below what anyone measures.
constexpr double kLeastStep = 1.0 / 16384, kLargestStep = 1.0 / 64;

/// Moves apart the points that a grain has at one place.
class PlaceSplitter {
 public:
  PlaceSplitter(const GrainMesh& mesh, const openvdb::math::Transform& transform, size_t grain,
                std::vector<Vec3f>& points)
      : mesh_(mesh),
        transform_(transform),
        first_(mesh.firstPoint[grain]),
        end_(mesh.firstPoint[grain + 1]),
        firstTriangle_(mesh.firstTriangle[grain]),
        endTriangle_(mesh.firstTriangle[grain + 1]),
        points_(points) {}

  void split() {
    const std::vector<uint32_t> crowded = crowdedPoints();
    if (crowded.empty()) return;
    const std::vector<Vec3d> inwards = inwardsAt(crowded);
    for (double step = kLeastStep; step <= kLargestStep; step *= 2) {
      for (size_t n = 0; n < crowded.size(); ++n)
        points_[crowded[n]] =
            Vec3f(transform_.indexToWorld(Vec3d(mesh_.points[crowded[n]]) + step * inwards[n]));
      if (crowdedPoints().empty()) return;
    }
  }

 private:
  /// Those at the place of another, ascending.
  std::vector<uint32_t> crowdedPoints() const {
    std::vector<uint32_t> order(end_ - first_), crowded;
    std::iota(order.begin(), order.end(), first_);
    detail::parallelSort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) {
      const Vec3f &p = points_[a], &q = points_[b];
      return std::tuple(p[0], p[1], p[2], a) < std::tuple(q[0], q[1], q[2], b);
    });
    for (size_t i = 0; i < order.size(); ++i) {
      const Vec3f& p = points_[order[i]];
      if ((i > 0 && points_[order[i - 1]] == p) ||
          (i + 1 < order.size() && points_[order[i + 1]] == p))
        crowded.push_back(order[i]);
    }
    std::sort(crowded.begin(), crowded.end());
    return crowded;
  }

  /// Unit vectors, or 0 where the triangles around a point say nothing.
  std::vector<Vec3d> inwardsAt(const std::vector<uint32_t>& crowded) const {
    std::vector<uint32_t> place(end_ - first_);  // in `crowded`, from 1; 0: not there
    for (size_t n = 0; n < crowded.size(); ++n) place[crowded[n] - first_] = uint32_t(n + 1);
    std::vector<Vec3d> inwards(crowded.size());
    for (uint32_t t = firstTriangle_; t < endTriangle_; ++t) {
      const auto& [a, b, c] = mesh_.triangles[t];
      for (const uint32_t corner : {a, b, c}) {
        if (place[corner - first_] == 0) continue;
        const Vec3d p(mesh_.points[a]), q(mesh_.points[b]), r(mesh_.points[c]);
        inwards[place[corner - first_] - 1] -= (q - p).cross(r - p);
      }
    }
    for (Vec3d& vector : inwards)
      if (vector.lengthSqr() > 0) vector.normalize();
    return inwards;
  }

  const GrainMesh& mesh_;
  const openvdb::math::Transform& transform_;
  const uint32_t first_, end_, firstTriangle_, endTriangle_;
  std::vector<Vec3f>& points_;
};

}  // namespace

std::vector<Vec3f> worldPoints(const GrainMesh& mesh, const openvdb::math::Transform& transform) {
  std::vector<Vec3f> points(mesh.points.size());
  detail::parallelForEach(points.size(), kPointGrain, nullptr, [&](size_t i) {
    points[i] = Vec3f(transform.indexToWorld(Vec3d(mesh.points[i])));
  });
  detail::parallelForEach(mesh.labels.size(), 1, nullptr, [&](size_t grain) {
    PlaceSplitter(mesh, transform, grain, points).split();
  });
  return points;
}

}  // namespace vdb_madf
