// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "vdb_madf/measure/measure_grains.h"
#include "vdb_madf/shapes/grain_mesh.h"

namespace vdb_madf::detail {

/// The mesh as the page has it, and what the page has to know to read it.
struct PackedMesh {
  /// First come, 32 bits each and grain by grain, numbers of points, of triangles; then origins x,
  /// y, z of grain 0, 1 ..., signed, in steps. Then planes of bytes (PackedBytes::planes): of 16
  /// bits for all x, all y, all z of the points, each the difference to the point before it in its
  /// grain (to the origin, of the first) in steps, 2 |d| if it is not negative and 2 |d| - 1 if it
  /// is; of 32 bits for the corners of the triangles: the number of points of its grain that
  /// corners before named, less the point's own.
  std::string text;
  double step = 0;  ///< in voxels: points are rounded to it
  uint64_t points = 0, triangles = 0;
};

/// \p grains: by id, those of the mesh among them. One without triangles is shown as an octahedron
/// of its volume at its centroid. \p step: as fine as is wanted, in voxels; becomes coarser where a
/// grain is longer than 32,000 steps.
PackedMesh packMesh(const GrainMesh& mesh, const std::vector<GrainMeasures>& grains, double step);

}  // namespace vdb_madf::detail
