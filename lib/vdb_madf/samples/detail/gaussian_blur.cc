// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/samples/detail/gaussian_blur.h"

#include <cmath>

#include "vdb_madf/base/detail/gaussian.h"
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

/// The points that a Gaussian around a place sees along an axis, and their weights.
struct Window {
  int first;
  std::vector<float> weights;

  Window(double place, double sigma) : first(int(std::ceil(place - gaussianRadius(sigma)))) {
    const int last = int(std::floor(place + gaussianRadius(sigma)));
    std::vector<double> values;
    double sum = 0;
    for (int i = first; i <= last; ++i) {
      values.push_back(exponential(-((i - place) * (i - place) / (2 * sigma * sigma))));
      sum += values.back();
    }
    for (const double value : values) weights.push_back(float(value / sum));
  }
};

/// The box of points with the voxels of the lattice along one axis.
FloatBox convolvedAt(const CoordBBox& voxels, const Lattice& lattice, const FloatBox& in,
                     double sigma, int axis) {
  CoordBBox box = in.box;
  box.min()[axis] = voxels.min()[axis];
  box.max()[axis] = voxels.max()[axis];
  FloatBox out(box);
  const Coord dim = in.box.dim();
  const ptrdiff_t stride = axis == 0 ? ptrdiff_t(dim.y()) * dim.z() : axis == 1 ? dim.z() : 1;
  for (int i = box.min()[axis]; i <= box.max()[axis]; ++i) {
    const Window window(lattice.place(axis, i), sigma);
    CoordBBox layer = box;
    layer.min()[axis] = layer.max()[axis] = i;
    for (auto p = layer.begin(); p; ++p) {
      Coord from = *p;
      from[axis] = window.first;
      const float* value = in.values.data() + in.offset(from.x(), from.y(), from.z());
      float sum = 0;
      for (size_t k = 0; k < window.weights.size(); ++k)
        sum += window.weights[k] * value[ptrdiff_t(k) * stride];
      out.values[out.offset((*p).x(), (*p).y(), (*p).z())] = sum;
    }
  }
  return out;
}

}  // namespace

std::vector<float> gaussianKernel(double sigma) {
  const std::vector<double> weights = gaussianWeights(sigma);
  return {weights.begin(), weights.end()};
}

FloatBox blurred(FloatBox field, const std::vector<float>& kernel, Interrupter* interrupter) {
  for (int axis = 2; axis >= 0; --axis) field = convolved(field, kernel, axis, interrupter);
  return field;
}

CoordBBox pointsSeen(const CoordBBox& voxels, const Lattice& lattice, double sigma) {
  CoordBBox points;
  for (int axis = 0; axis < 3; ++axis) {
    points.min()[axis] =
        int(std::ceil(lattice.place(axis, voxels.min()[axis]) - gaussianRadius(sigma)));
    points.max()[axis] =
        int(std::floor(lattice.place(axis, voxels.max()[axis]) + gaussianRadius(sigma)));
  }
  return points;
}

FloatBox blurredAt(const CoordBBox& voxels, const Lattice& lattice, FloatBox field, double sigma) {
  const std::vector<float> kernel = gaussianKernel(sigma);
  for (int axis = 2; axis >= 0; --axis)
    field = lattice.edge(axis) == 1 ? convolved(field, kernel, axis, nullptr)
                                    : convolvedAt(voxels, lattice, field, sigma, axis);
  return field;
}

}  // namespace vdb_madf::detail
