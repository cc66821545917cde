// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "vdb_madf/grids/grid_types.h"

namespace vdb_madf::detail {

/// The surfaces of all grains before they are cut into triangles. A corner is a point of the voxel
/// lattice where labels meet; a point is a corner as one grain sees it.
struct SurfaceNet {
  static constexpr uint32_t kNone = 0xffffffffu;

  std::vector<Coord> corners;                  ///< at c - 1/2
  std::vector<uint32_t> firstPoint;            ///< per corner, one more at the end: its points
  std::vector<uint32_t> pointGrain;            ///< per point
  std::vector<uint32_t> firstQuad;             ///< per grain, one more at the end
  std::vector<std::array<uint32_t, 4>> quads;  ///< of points, counterclockwise from outside
  std::vector<uint32_t> pointCorner;           ///< per point

  /// Corners linked to one: -x, +x, -y, +y, -z, +z; kNone where all voxels around the edge between
  /// them are alike. Filled for smoothing only.
  std::vector<std::array<uint32_t, 6>> links;
  /// Bit d: around the link in direction d there are three labels or more (background counts).
  std::vector<uint8_t> junctions;
};

/// Positions of the corners after `rounds` of smoothing; see grainMesh(). Turns the quads so that
/// the first and the third corner are the nearer ones. \p volumes: of the grains, in voxels.
std::vector<openvdb::Vec3f> relax(SurfaceNet& net, int rounds, const std::vector<int64_t>& volumes,
                                  Interrupter* interrupter);

}  // namespace vdb_madf::detail
