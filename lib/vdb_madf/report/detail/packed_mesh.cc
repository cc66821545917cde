// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/report/detail/packed_mesh.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "vdb_madf/report/detail/packed_bytes.h"

namespace vdb_madf::detail {

namespace {

using openvdb::Vec3f;

constexpr double kMostSteps = 32000;  // folded(), they take 16 bits
constexpr uint32_t kUnnamed = std::numeric_limits<uint32_t>::max();

/// A body of its own.
struct Body {
  std::vector<Vec3f> points;
  std::vector<std::array<uint32_t, 3>> triangles;
};

/// An octahedron of half axis h has the volume 4/3 h^3.
Body octahedron(const GrainMeasures& grain) {
  const double half = std::cbrt(0.75 * double(grain.voxels));
  Body body;
  for (int axis = 0; axis < 3; ++axis)
    for (const double sign : {1.0, -1.0}) {
      openvdb::Vec3d point = grain.centroid;
      point[axis] += sign * half;
      body.points.emplace_back(point);
    }
  for (const uint32_t x : {0u, 1u})
    for (const uint32_t y : {2u, 3u})
      for (const uint32_t z : {4u, 5u})
        body.triangles.push_back((x + y + z) % 2 == 0 ? std::array<uint32_t, 3>{x, y, z}
                                                      : std::array<uint32_t, 3>{x, z, y});
  return body;
}

Body bodyOf(const GrainMesh& mesh, size_t grain) {
  Body body;
  body.points.assign(mesh.points.begin() + mesh.firstPoint[grain],
                     mesh.points.begin() + mesh.firstPoint[grain + 1]);
  for (uint32_t i = mesh.firstTriangle[grain]; i < mesh.firstTriangle[grain + 1]; ++i) {
    body.triangles.push_back(mesh.triangles[i]);
    for (uint32_t& corner : body.triangles.back()) corner -= mesh.firstPoint[grain];
  }
  return body;
}

/// Points in the order in which triangles name them; without those that none does.
Body inOrderOfUse(const Body& body) {
  Body result;
  std::vector<uint32_t> renamed(body.points.size(), kUnnamed);
  for (std::array<uint32_t, 3> triangle : body.triangles) {
    for (uint32_t& corner : triangle) {
      if (renamed[corner] == kUnnamed) {
        renamed[corner] = uint32_t(result.points.size());
        result.points.push_back(body.points[corner]);
      }
      corner = renamed[corner];
    }
    result.triangles.push_back(triangle);
  }
  return result;
}

std::vector<Body> bodiesOf(const GrainMesh& mesh, const std::vector<GrainMeasures>& grains) {
  std::vector<Body> bodies;
  size_t next = 0;
  for (const GrainMeasures& grain : grains) {
    const bool isThere = next < mesh.labels.size() && mesh.labels[next] == grain.id;
    bodies.push_back(inOrderOfUse(isThere && mesh.firstTriangle[next + 1] > mesh.firstTriangle[next]
                                      ? bodyOf(mesh, next)
                                      : octahedron(grain)));
    if (isThere) ++next;
  }
  return bodies;
}

double longestEdge(const std::vector<Body>& bodies) {
  double longest = 0;
  for (const Body& body : bodies) {
    Vec3f low = body.points.front(), high = low;
    for (const Vec3f& point : body.points) {
      low = openvdb::math::minComponent(low, point);
      high = openvdb::math::maxComponent(high, point);
    }
    const Vec3f size = high - low;
    longest = std::max({longest, double(size[0]), double(size[1]), double(size[2])});
  }
  return longest;
}

uint16_t folded(int64_t difference) {
  return uint16_t(difference < 0 ? -2 * difference - 1 : 2 * difference);
}

class Packer {
 public:
  explicit Packer(double step) : step_(step) {}

  void add(const Body& body) {
    pointCounts_.push_back(uint32_t(body.points.size()));
    triangleCounts_.push_back(uint32_t(body.triangles.size()));
    for (int axis = 0; axis < 3; ++axis) {
      int64_t before = steps(body.points.front()[axis]);
      origins_.push_back(uint32_t(before));
      for (const Vec3f& point : body.points) {
        const int64_t place = steps(point[axis]);
        places_[size_t(axis)].push_back(folded(place - before));
        before = place;
      }
    }
    uint32_t named = 0;
    for (const std::array<uint32_t, 3>& triangle : body.triangles)
      for (const uint32_t corner : triangle) {
        corners_.push_back(named - corner);
        if (corner == named) ++named;
      }
  }

  PackedMesh result() const {
    PackedBytes bytes;
    for (const auto* values : {&pointCounts_, &triangleCounts_, &origins_})
      bytes.bytes(values->data(), values->size() * sizeof(uint32_t));
    for (const std::vector<uint16_t>& places : places_) bytes.planes(places);
    bytes.planes(corners_);
    return {bytes.text(), step_, places_[0].size(), corners_.size() / 3};
  }

 private:
  int64_t steps(float place) const { return std::llround(double(place) / step_); }

  double step_;
  std::vector<uint32_t> pointCounts_, triangleCounts_, origins_, corners_;
  std::array<std::vector<uint16_t>, 3> places_;
};

}  // namespace

PackedMesh packMesh(const GrainMesh& mesh, const std::vector<GrainMeasures>& grains, double step) {
  const std::vector<Body> bodies = bodiesOf(mesh, grains);
  Packer packer(std::max(step, longestEdge(bodies) / kMostSteps));
  for (const Body& body : bodies) packer.add(body);
  return packer.result();
}

}  // namespace vdb_madf::detail
