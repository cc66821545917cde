// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/samples/detail/lattice.h"

#include <fmt/core.h>

#include <cmath>

#include "vdb_madf/base/detail/text.h"
#include "vdb_madf/base/errors.h"

namespace vdb_madf::detail {

namespace {

constexpr double kDecimals = 1e9;
/// A box is covered if this part of a voxel is missing.
constexpr double kTolerance = 1e-6;

}  // namespace

Lattice::Lattice(const std::optional<VoxelSize>& voxelSize) {
  if (!voxelSize || voxelSize->isCube()) return;
  for (int axis = 0; axis < 3; ++axis)
    edges_[axis] =
        std::round(voxelSize->edges()[size_t(axis)] / voxelSize->shortestEdge() * kDecimals) /
        kDecimals;
}

Coord Lattice::voxels(const Coord& size) const {
  Coord result;
  for (int axis = 0; axis < 3; ++axis) {
    if (edges_[axis] > size[axis] + kTolerance)
      throw InvalidInput(
          fmt::format("a voxel is longer than the sample along {}, where it measures {} of its "
                      "shortest edges, the sample {}: use a larger size",
                      "xyz"[axis], shortestDecimal(edges_[axis]), size[axis]));
    result[axis] = int(std::ceil(size[axis] / edges_[axis] - kTolerance));
  }
  return result;
}

CoordBBox Lattice::voxelsIn(const CoordBBox& places) const {
  CoordBBox result;
  for (int axis = 0; axis < 3; ++axis) {
    result.min()[axis] = int(std::floor(index(axis, places.min()[axis])));
    result.max()[axis] = int(std::ceil(index(axis, places.max()[axis])));
  }
  return result;
}

}  // namespace vdb_madf::detail
