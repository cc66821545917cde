// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <array>
#include <string>

namespace vdb_madf {

/// True for three lengths > 0 that differ by at most 0.1 % (kMaxEdgeRatio).
bool areEdgesOfCube(const std::array<double, 3>& edges);

/// Edges of a voxel and the unit that the transform of a grid is written in.
///
/// OpenVDB refuses transforms with a voxel volume below 3e-15, so meters do not work for micro-CT:
/// grids are written in millimeters (below 20 nm: micrometers), the SI size stands in metadata.
class VoxelSize {
 public:
  /// A cube. @param edge meters, > 0
  explicit VoxelSize(double edge) : edges_{edge, edge, edge} {}
  /// @param edges meters, > 0, along x, y and z. Those of a cube are all taken for that along x.
  explicit VoxelSize(const std::array<double, 3>& edges);

  /// The edges along x, y and z, meters.
  const std::array<double, 3>& edges() const { return edges_; }
  bool isCube() const { return edges_[0] == edges_[1] && edges_[0] == edges_[2]; }
  double edge() const;          ///< meters. @pre isCube()
  double shortestEdge() const;  ///< meters
  /// The edge of the cube of equal volume, meters; the edge itself, if it is a cube.
  double meanEdge() const;

  /// "mm", or "um" if an edge is below 20 nm.
  std::string unit() const;
  /// Edges in unit().
  std::array<double, 3> edgesInUnit() const;
  /// Edge in unit(). @pre isCube()
  double inUnit() const;

 private:
  std::array<double, 3> edges_;
};

}  // namespace vdb_madf
