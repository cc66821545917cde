// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "vdb_madf/pictures/detail/camera.h"
#include "vdb_madf/shapes/grain_mesh.h"

namespace vdb_madf::detail {

/// Which triangle of a mesh is seen where: a depth buffer, for a band of rows of a picture at a
/// time.
class SurfaceRaster {
 public:
  static constexpr int kBand = 8;     ///< rows of pixels
  static constexpr int kSamples = 3;  ///< along each edge of a pixel
  static constexpr uint32_t kNothing = std::numeric_limits<uint32_t>::max();

  struct Sample {
    float t = std::numeric_limits<float>::infinity();  ///< along the ray from its origin
    uint32_t triangle = kNothing;
  };
  using Samples = std::vector<Sample>;

  /// @param edges of a voxel; @param mesh is kept by reference, as is the camera
  SurfaceRaster(const GrainMesh& mesh, const openvdb::Vec3d& edges, const Camera& camera);

  int bandCount() const { return int(firstOfBand_.size()) - 1; }
  /// The samples of a band, row by row: the nearest triangle that faces the camera; of equally near
  /// ones the first.
  void draw(int band, Samples& samples) const;
  /// Sample (i, j) of pixel x in row y of a band, in `samples`.
  size_t place(int x, int y, int i, int j) const {
    return (size_t(y) * kSamples + size_t(j)) * size_t(camera_.width) * kSamples +
           size_t(x) * kSamples + size_t(i);
  }
  int32_t labelOf(uint32_t triangle) const;

 private:
  /// A place in samples of the picture, and along the rays.
  struct Corner {
    double x, y, t;
  };
  Corner cornerOf(uint32_t point) const;
  void draw(uint32_t triangle, int firstRow, Samples& samples) const;

  const GrainMesh& mesh_;
  const openvdb::Vec3d edges_;
  const Camera& camera_;
  std::vector<size_t> firstOfBand_;
  std::vector<uint32_t> trianglesOfBand_;  ///< ascending in each
};

}  // namespace vdb_madf::detail
