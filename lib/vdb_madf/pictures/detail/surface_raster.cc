// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/pictures/detail/surface_raster.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace vdb_madf::detail {

SurfaceRaster::SurfaceRaster(const GrainMesh& mesh, const openvdb::Vec3d& edges,
                             const Camera& camera)
    : mesh_(mesh),
      edges_(edges),
      camera_(camera),
      firstOfBand_(size_t((camera.height + kBand - 1) / kBand) + 1, 0) {
  const auto bandsOf = [&](const std::array<uint32_t, 3>& corners) {
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (const uint32_t corner : corners) {
      const double y = cornerOf(corner).y;
      low = std::min(low, y);
      high = std::max(high, y);
    }
    const double last = bandCount() - 1, rows = kBand * kSamples;
    return std::pair(size_t(std::clamp(std::floor(low / rows), 0., last)),
                     size_t(std::clamp(std::floor(high / rows), 0., last)));
  };
  for (const auto& corners : mesh.triangles) {
    const auto [first, last] = bandsOf(corners);
    for (size_t band = first; band <= last; ++band) ++firstOfBand_[band + 1];
  }
  for (size_t band = 1; band < firstOfBand_.size(); ++band)
    firstOfBand_[band] += firstOfBand_[band - 1];
  trianglesOfBand_.resize(firstOfBand_.back());
  std::vector<size_t> next(firstOfBand_.begin(), firstOfBand_.end() - 1);
  for (size_t triangle = 0; triangle < mesh.triangles.size(); ++triangle) {
    const auto [first, last] = bandsOf(mesh.triangles[triangle]);
    for (size_t band = first; band <= last; ++band)
      trianglesOfBand_[next[band]++] = uint32_t(triangle);
  }
}

SurfaceRaster::Corner SurfaceRaster::cornerOf(uint32_t point) const {
  const openvdb::Vec3d p = (openvdb::Vec3d(mesh_.points[point]) + openvdb::Vec3d(0.5)) * edges_;
  const Point at = camera_.project(p);
  return {kSamples * at[0], kSamples * at[1], camera_.direction.dot(p - camera_.center)};
}

void SurfaceRaster::draw(int band, Samples& samples) const {
  samples.assign(size_t(camera_.width) * kSamples * kBand * kSamples, Sample());
  for (size_t i = firstOfBand_[size_t(band)]; i < firstOfBand_[size_t(band) + 1]; ++i)
    draw(trianglesOfBand_[i], band * kBand * kSamples, samples);
}

void SurfaceRaster::draw(uint32_t triangle, int firstRow, Samples& samples) const {
  std::array<Corner, 3> corner{};
  for (size_t k = 0; k < 3; ++k) corner[k] = cornerOf(mesh_.triangles[triangle][k]);
  const auto& [a, b, c] = corner;
  // y is down: what is counterclockwise from outside has a negative area if it faces the camera.
  const double area = (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
  if (!(area < 0)) return;
  const int width = camera_.width * kSamples, rows = kBand * kSamples;
  // Samples lie in the middles of their squares.
  const auto first = [](double low) { return int(std::ceil(low - 0.5)); };
  const auto last = [](double high) { return int(std::floor(high - 0.5)); };
  const int left = std::max(0, first(std::min({a.x, b.x, c.x}))),
            right = std::min(width - 1, last(std::max({a.x, b.x, c.x}))),
            top = std::max(0, first(std::min({a.y, b.y, c.y})) - firstRow),
            bottom = std::min(rows - 1, last(std::max({a.y, b.y, c.y})) - firstRow);
  for (int row = top; row <= bottom; ++row)
    for (int column = left; column <= right; ++column) {
      const double x = column + 0.5, y = firstRow + row + 0.5;
      const double u = ((b.x - x) * (c.y - y) - (b.y - y) * (c.x - x)) / area,
                   v = ((c.x - x) * (a.y - y) - (c.y - y) * (a.x - x)) / area, w = 1 - u - v;
      if (u < 0 || v < 0 || w < 0) continue;
      Sample& sample = samples[size_t(row) * size_t(width) + size_t(column)];
      const auto t = float(u * a.t + v * b.t + w * c.t);
      if (t < sample.t) sample = {t, triangle};
    }
}

int32_t SurfaceRaster::labelOf(uint32_t triangle) const {
  const auto& first = mesh_.firstTriangle;
  const auto next = std::upper_bound(first.begin(), first.end(), triangle);
  return mesh_.labels[size_t(next - first.begin()) - 1];
}

}  // namespace vdb_madf::detail
