// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include <algorithm>
#include <map>
#include <tuple>
#include <utility>

#include "vdb_madf/base/detail/parallel.h"
#include "vdb_madf/base/detail/sorted.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/shapes/detail/surface_net.h"

namespace vdb_madf::detail {

namespace {

using openvdb::Vec3f;

constexpr size_t kTriangleGrain = 1 << 16;

class QuadCutter {
 public:
  QuadCutter(const SurfaceNet& net, std::vector<Vec3f> positions)
      : net_(net), isAtPinch_(net.corners.size()) {
    positions.resize(net.corners.size());
    for (const auto& [low, high] : net.pinches) {
      isAtPinch_[low] = isAtPinch_[high] = true;
      positions.push_back(0.5f * (positions[low] + positions[high]));
    }
    mesh_.positions = std::move(positions);
    mesh_.pointSite = net.pointCorner;
    mesh_.pointGrain = net.pointGrain;
  }

  SharedMesh cut() {
    mesh_.triangles.reserve(2 * net_.quads.size());
    mesh_.beyond.reserve(2 * net_.quads.size());
    for (size_t g = 0; g + 1 < net_.firstQuad.size(); ++g) {
      for (uint32_t quad = net_.firstQuad[g]; quad < net_.firstQuad[g + 1]; ++quad) {
        const auto& [a, b, c, d] = net_.quads[quad];
        addTriangle(quad, {a, b, c});
        addTriangle(quad, {a, c, d});
      }
      if (mesh_.triangles.size() >= SharedMesh::kNone)
        throw InvalidInput(
            "the meshes have more than 4,294,967,294 points or triangles: coarsen or crop the "
            "volume");
      mesh_.firstTriangle.push_back(uint32_t(mesh_.triangles.size()));
    }
    sortPoints();
    return std::move(mesh_);
  }

 private:
  using Triangle = std::array<uint32_t, 3>;

  /// Sorts the points by grain.
  void sortPoints() {
    const Lists points(mesh_.pointGrain, mesh_.grainCount());
    std::vector<uint32_t> place(points.items.size()), sites(points.items.size());
    for (uint32_t i = 0; i < place.size(); ++i) {
      place[points.items[i]] = i;
      sites[i] = mesh_.pointSite[points.items[i]];
    }
    mesh_.pointSite = std::move(sites);
    for (size_t g = 0; g < mesh_.grainCount(); ++g)
      std::fill(mesh_.pointGrain.begin() + points.first[g],
                mesh_.pointGrain.begin() + points.first[g + 1], uint32_t(g));
    parallelForEach(mesh_.triangles.size(), kTriangleGrain, nullptr, [&](size_t i) {
      for (uint32_t& point : mesh_.triangles[i]) point = place[point];
    });
  }

  /// Cuts edges in the order of pinches, which is the same on both sides of an interface.
  void addTriangle(uint32_t quad, const Triangle& triangle) {
    size_t first = net_.pinches.size(), side = 0;
    for (size_t n = 0; n < 3; ++n) {
      const size_t pinch = pinchOf(triangle[n], triangle[(n + 1) % 3]);
      if (pinch >= first) continue;
      first = pinch;
      side = n;
    }
    if (first == net_.pinches.size()) {
      mesh_.triangles.push_back(triangle);
      mesh_.beyond.push_back(net_.quadBeyond[quad]);
      return;
    }
    const uint32_t a = triangle[side], b = triangle[(side + 1) % 3], c = triangle[(side + 2) % 3];
    const uint32_t middle = middleOf(quad, first);
    addTriangle(quad, {a, middle, c});
    addTriangle(quad, {middle, b, c});
  }

  /// pinches.size() if the edge is none.
  size_t pinchOf(uint32_t a, uint32_t b) const {
    const uint32_t from = mesh_.pointSite[a], to = mesh_.pointSite[b];
    const size_t none = net_.pinches.size(), corners = isAtPinch_.size();
    if (from >= corners || to >= corners || !isAtPinch_[from] || !isAtPinch_[to]) return none;
    const std::array<uint32_t, 2> edge{std::min(from, to), std::max(from, to)};
    return findSorted(net_.pinches, edge).value_or(none);
  }

  /// The two quads of a voxel share a point there.
  uint32_t middleOf(uint32_t quad, size_t pinch) {
    const uint32_t grain = mesh_.pointGrain[net_.quads[quad][0]];
    const auto [place, isNew] =
        middles_.emplace(std::tuple(pinch, grain, voxelOf(quad)), uint32_t(mesh_.pointSite.size()));
    if (isNew) {
      mesh_.pointSite.push_back(uint32_t(net_.corners.size() + pinch));
      mesh_.pointGrain.push_back(grain);
    }
    return place->second;
  }

  /// The voxel that the face is one of.
  Coord voxelOf(uint32_t quad) const {
    std::array<Coord, 4> corners;
    for (size_t n = 0; n < 4; ++n) corners[n] = net_.corners[net_.pointCorner[net_.quads[quad][n]]];
    Coord low = corners[0];
    for (const Coord& corner : corners) low.minComponent(corner);
    const openvdb::Vec3i out =
        (corners[1] - corners[0]).asVec3i().cross((corners[2] - corners[0]).asVec3i());
    for (int axis = 0; axis < 3; ++axis) low[axis] -= out[axis] > 0;
    return low;
  }

  const SurfaceNet& net_;
  std::vector<bool> isAtPinch_;  // per corner
  std::map<std::tuple<size_t, uint32_t, Coord>, uint32_t> middles_;
  SharedMesh mesh_;
};

}  // namespace

SharedMesh cutQuads(const SurfaceNet& net, std::vector<Vec3f> positions) {
  return QuadCutter(net, std::move(positions)).cut();
}

}  // namespace vdb_madf::detail
