// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "vdb_madf/grids/grid_types.h"
#include "vdb_madf/shapes/detail/shared_mesh.h"

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
  std::vector<int32_t> quadBeyond;             ///< see SharedMesh
  std::vector<uint32_t> pointCorner;           ///< per point
  /// Edges of the lattice, by the corners at their ends, where four quads of a grain have the same
  /// two points; ascending.
  std::vector<std::array<uint32_t, 2>> pinches;

  /// Corners linked to one: -x, +x, -y, +y, -z, +z; kNone where all voxels around the edge between
  /// them are alike. Filled for smoothing only.
  std::vector<std::array<uint32_t, 6>> links;
  /// Bit d: around the link in direction d there are three labels or more (background counts, and
  /// as another one what is outside of the domain).
  std::vector<uint8_t> junctions;
};

/// Where nothing has moved: corner c is at c - 1/2; then the middles of the pinches.
std::vector<openvdb::Vec3f> latticePositions(const SurfaceNet& net);

/// Positions of the corners after `rounds` of smoothing; see grainMesh(). Turns the quads so that
/// the first and the third corner are the nearer ones, and uses the links up. @throw Interrupted
std::vector<openvdb::Vec3f> relax(SurfaceNet& net, int rounds, const DomainFaces& domain,
                                  Interrupter* interrupter);

/// Cuts the quads into triangles, and the pinches in their middles: each edge then has two
/// triangles of a grain. Sites are the corners, then those middles. \param positions: of the
/// corners
/// @throw InvalidInput for more than 2^32 - 1 triangles
SharedMesh cutQuads(const SurfaceNet& net, std::vector<openvdb::Vec3f> positions);

}  // namespace vdb_madf::detail
