// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/samples/detail/gaussian_blur.h"

#include <algorithm>

#include "vdb_madf/base/detail/parallel.h"
#include "vdb_madf/base/detail/portable_math.h"

namespace vdb_madf::detail {

namespace {

/// out[i] = sum of kernel[|k|] * in[i + k * stride], for a row of values next to each other.
void convolveRow(const float* in, ptrdiff_t stride, const std::vector<float>& kernel, float* out,
                 int count) {
  for (int i = 0; i < count; ++i) out[i] = kernel[0] * in[i];
  for (size_t k = 1; k < kernel.size(); ++k) {
    const float weight = kernel[k];
    const float* below = in - ptrdiff_t(k) * stride;
    const float* above = in + ptrdiff_t(k) * stride;
    for (int i = 0; i < count; ++i) out[i] += weight * (below[i] + above[i]);
  }
}

FloatBox convolved(const FloatBox& in, const std::vector<float>& kernel, int axis,
                   Interrupter* interrupter) {
  CoordBBox inner = in.box;
  inner.min()[axis] += kernelRadius(kernel);
  inner.max()[axis] -= kernelRadius(kernel);
  FloatBox out(inner);
  const Coord dim = in.box.dim();
  const ptrdiff_t stride = axis == 0 ? ptrdiff_t(dim.y()) * dim.z() : axis == 1 ? dim.z() : 1;
  const size_t planes = size_t(inner.dim().x());
  const size_t grain = in.values.size() < kSequentialValues ? planes : 1;
  parallelFor(planes, grain, interrupter, [&](size_t begin, size_t end) {
    for (int x = inner.min().x() + int(begin); x < inner.min().x() + int(end); ++x)
      for (int y = inner.min().y(); y <= inner.max().y(); ++y)
        convolveRow(in.values.data() + in.offset(x, y, inner.min().z()), stride, kernel,
                    out.values.data() + out.offset(x, y, inner.min().z()), inner.dim().z());
  });
  return out;
}

}  // namespace

std::vector<float> gaussianKernel(double sigma) {
  const int radius = int(4 * sigma + 0.5);
  std::vector<double> weights;
  double sum = 0;
  for (int k = 0; k <= radius; ++k) {
    weights.push_back(exponential(-(k * k / (2 * sigma * sigma))));
    sum += k == 0 ? weights[k] : 2 * weights[k];
  }
  std::vector<float> kernel;
  for (const double weight : weights) kernel.push_back(float(weight / sum));
  return kernel;
}

FloatBox blurred(FloatBox field, const std::vector<float>& kernel, Interrupter* interrupter) {
  for (int axis = 2; axis >= 0; --axis) field = convolved(field, kernel, axis, interrupter);
  return field;
}

}  // namespace vdb_madf::detail
