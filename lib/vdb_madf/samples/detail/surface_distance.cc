// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/samples/detail/surface_distance.h"

#include <algorithm>
#include <cmath>

namespace vdb_madf::detail {

namespace {

/// The least of in[q] + |p - q|^2 over the q within reach of p along the axis.
FloatBox leastAlong(const FloatBox& in, int axis, int reach) {
  CoordBBox inner = in.box;
  inner.min()[axis] += reach;
  inner.max()[axis] -= reach;
  FloatBox out(inner);
  const Coord dim = in.box.dim();
  const ptrdiff_t stride = axis == 0 ? ptrdiff_t(dim.y()) * dim.z() : axis == 1 ? dim.z() : 1;
  const int count = inner.dim().z();
  for (int x = inner.min().x(); x <= inner.max().x(); ++x)
    for (int y = inner.min().y(); y <= inner.max().y(); ++y) {
      const float* row = in.values.data() + in.offset(x, y, inner.min().z());
      float* least = out.values.data() + out.offset(x, y, inner.min().z());
      std::copy(row, row + count, least);
      for (int k = 1; k <= reach; ++k) {
        const float square = float(k * k);
        const float *below = row - k * stride, *above = row + k * stride;
        for (int i = 0; i < count; ++i)
          least[i] = std::min(least[i], std::min(below[i], above[i]) + square);
      }
    }
  return out;
}

/// Squared distance to the nearest voxel with this value.
FloatBox squaredDistance(const FloatBox& object, float value, int reach) {
  const float far = 4.0f * float((reach + 1) * (reach + 1));
  FloatBox field = object;
  for (float& v : field.values) v = v == value ? 0 : far;
  for (int axis = 2; axis >= 0; --axis) field = leastAlong(field, axis, reach);
  return field;
}

}  // namespace

FloatBox surfaceDistance(const FloatBox& object, int reach) {
  FloatBox result = squaredDistance(object, 1, reach);
  const FloatBox toAir = squaredDistance(object, 0, reach);
  for (size_t i = 0; i < result.values.size(); ++i) {
    float& v = result.values[i];
    v = v > 0 ? std::sqrt(v) - 0.5f : 0.5f - std::sqrt(toAir.values[i]);
  }
  return result;
}

}  // namespace vdb_madf::detail
