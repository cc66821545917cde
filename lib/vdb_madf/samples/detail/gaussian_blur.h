// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <vector>

#include "vdb_madf/grids/grid_types.h"
#include "vdb_madf/samples/detail/lattice.h"

namespace vdb_madf::detail {

/// A dense box of values, z fastest.
struct FloatBox {
  CoordBBox box;
  std::vector<float> values;

  explicit FloatBox(const CoordBBox& b) : box(b), values(size_t(b.volume())) {}
  size_t offset(int x, int y, int z) const {
    const Coord dim = box.dim();
    return (size_t(x - box.min().x()) * dim.y() + (y - box.min().y())) * dim.z() +
           (z - box.min().z());
  }
};

/// Boxes below this many values are worked on by the calling thread alone.
constexpr size_t kSequentialValues = size_t(1) << 23;

/// The weights of gaussianWeights() as floats.
std::vector<float> gaussianKernel(double sigma);

/// The farthest voxel that the kernel sees.
inline int kernelRadius(const std::vector<float>& kernel) {
  return int(kernel.size()) - 1;
}

/// The separable convolution where the kernel fits: each face moves in by the kernel's radius.
/// Parallel if the box is large. @throw Interrupted
FloatBox blurred(FloatBox field, const std::vector<float>& kernel, Interrupter* interrupter);

/// The points of Z^3 that a Gaussian, cut at 4 sigma, sees from voxels of a lattice.
CoordBBox pointsSeen(const CoordBBox& voxels, const Lattice& lattice, double sigma);

/// What a field on these points is at the voxels when it is blurred: of cubes as above, along
/// longer edges by a Gaussian around the place of each voxel, which need not be one of the points.
FloatBox blurredAt(const CoordBBox& voxels, const Lattice& lattice, FloatBox field, double sigma);

}  // namespace vdb_madf::detail
