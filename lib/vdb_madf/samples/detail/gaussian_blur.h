// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <vector>

#include "vdb_madf/grids/grid_types.h"

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

/// One side of a normalised, sampled Gaussian, centre first, cut at 4 sigma. The same bits on every
/// machine: no library exponential.
std::vector<float> gaussianKernel(double sigma);

/// The farthest voxel that the kernel sees.
inline int kernelRadius(const std::vector<float>& kernel) {
  return int(kernel.size()) - 1;
}

/// The separable convolution where the kernel fits: each face moves in by the kernel's radius.
/// Parallel if the box is large. @throw Interrupted
FloatBox blurred(FloatBox field, const std::vector<float>& kernel, Interrupter* interrupter);

}  // namespace vdb_madf::detail
