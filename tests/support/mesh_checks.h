// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "vdb_madf/shapes/grain_mesh.h"

/// What is true of meshes, by going through their edges.
namespace vdb_madf::test {

/// Empty if every grain of the mesh is closed and oriented by itself: each edge is used once
/// one way and once the other, every triangle has three points, all points are used and those of
/// its grain.
inline std::string whyNotClosed(const GrainMesh& mesh) {
  if (mesh.firstPoint.size() != mesh.labels.size() + 1 || mesh.firstPoint.front() != 0 ||
      mesh.firstPoint.back() != mesh.points.size() ||
      mesh.firstTriangle.size() != mesh.labels.size() + 1 || mesh.firstTriangle.front() != 0 ||
      mesh.firstTriangle.back() != mesh.triangles.size())
    return "ranges";
  for (size_t g = 0; g < mesh.labels.size(); ++g) {
    std::map<std::pair<uint32_t, uint32_t>, int> edges;
    std::set<uint32_t> used;
    for (uint32_t t = mesh.firstTriangle[g]; t < mesh.firstTriangle[g + 1]; ++t) {
      const auto& triangle = mesh.triangles[t];
      for (size_t n = 0; n < 3; ++n) {
        const uint32_t from = triangle[n], to = triangle[(n + 1) % 3];
        if (from < mesh.firstPoint[g] || from >= mesh.firstPoint[g + 1]) return "foreign point";
        if (from == to) return "degenerate triangle";
        used.insert(from);
        ++edges[{std::min(from, to), std::max(from, to)}];
        edges[{std::min(from, to), std::max(from, to)}] += from < to ? 1000 : -1000;
      }
    }
    if (used.size() != mesh.firstPoint[g + 1] - mesh.firstPoint[g]) return "unused point";
    for (const auto& [edge, uses] : edges)
      if (uses != 2) return "edge of not two triangles, " + std::to_string(uses);
  }
  return "";
}

/// Empty if the triangles around every point make one disc: each of its edges in one fan.
inline std::string whyNoDisc(const GrainMesh& mesh) {
  std::vector<std::map<uint32_t, std::vector<uint32_t>>> next(mesh.points.size());
  for (const auto& t : mesh.triangles)
    for (size_t n = 0; n < 3; ++n) next[t[n]][t[(n + 1) % 3]].push_back(t[(n + 2) % 3]);
  for (const auto& ring : next) {
    size_t length = 0;
    for (const auto& [from, to] : ring) length += to.size();
    if (length != ring.size()) return "edge shared by four triangles";
    uint32_t at = ring.begin()->first;
    size_t steps = 0;
    do {
      at = ring.at(at)[0];
      ++steps;
    } while (at != ring.begin()->first && steps <= length);
    if (steps != length) return "several fans";
  }
  return "";
}

/// What a program sees that takes points of a grain at one place for one.
inline GrainMesh mergedByPlace(const GrainMesh& mesh, const std::vector<openvdb::Vec3f>& points) {
  GrainMesh merged;
  merged.labels = mesh.labels;
  merged.firstTriangle = mesh.firstTriangle;
  for (size_t g = 0; g < mesh.labels.size(); ++g) {
    std::map<openvdb::Vec3f, uint32_t> places;
    for (uint32_t i = mesh.firstPoint[g]; i < mesh.firstPoint[g + 1]; ++i)
      if (places.emplace(points[i], uint32_t(merged.points.size())).second)
        merged.points.push_back(points[i]);
    merged.firstPoint.push_back(uint32_t(merged.points.size()));
    for (uint32_t t = mesh.firstTriangle[g]; t < mesh.firstTriangle[g + 1]; ++t) {
      const auto& [a, b, c] = mesh.triangles[t];
      merged.triangles.push_back(
          {places.at(points[a]), places.at(points[b]), places.at(points[c])});
    }
  }
  return merged;
}

using Corners = std::array<std::array<float, 3>, 3>;

/// The corners of a triangle, or of the same one turned over, rotated to begin with the least:
/// equal if it is the same one.
inline Corners cornersOf(const GrainMesh& mesh, const std::array<uint32_t, 3>& triangle,
                         bool turned) {
  Corners corners;
  for (size_t n = 0; n < 3; ++n) {
    const openvdb::Vec3f& p = mesh.points[triangle[turned ? 2 - n : n]];
    corners[n] = {p.x(), p.y(), p.z()};
  }
  std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end()), corners.end());
  return corners;
}

}  // namespace vdb_madf::test
