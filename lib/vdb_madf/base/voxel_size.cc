// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/base/voxel_size.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "vdb_madf/base/limits.h"

namespace vdb_madf {

namespace {

/// Below this edge, millimeters would make a voxel volume that OpenVDB's transforms refuse.
constexpr double kMinMetresInMillimetres = 20e-9;

bool isSmall(const VoxelSize& size) {
  return size.shortestEdge() < kMinMetresInMillimetres;
}

}  // namespace

bool areEdgesOfCube(const std::array<double, 3>& edges) {
  const auto [min, max] = std::minmax_element(edges.begin(), edges.end());
  return *min > 0 && *max <= *min * kMaxEdgeRatio;
}

VoxelSize::VoxelSize(const std::array<double, 3>& edges) : edges_(edges) {
  if (areEdgesOfCube(edges)) edges_.fill(edges[0]);
}

double VoxelSize::edge() const {
  assert(isCube());
  return edges_[0];
}

double VoxelSize::shortestEdge() const {
  return *std::min_element(edges_.begin(), edges_.end());
}

double VoxelSize::meanEdge() const {
  return isCube() ? edges_[0] : std::cbrt(edges_[0] * edges_[1] * edges_[2]);
}

std::string VoxelSize::unit() const {
  return isSmall(*this) ? "um" : "mm";
}

std::array<double, 3> VoxelSize::edgesInUnit() const {
  const double perMetre = isSmall(*this) ? 1e6 : 1e3;
  return {edges_[0] * perMetre, edges_[1] * perMetre, edges_[2] * perMetre};
}

double VoxelSize::inUnit() const {
  assert(isCube());
  return edgesInUnit()[0];
}

}  // namespace vdb_madf
