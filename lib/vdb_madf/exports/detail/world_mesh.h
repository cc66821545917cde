// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <array>
#include <string>
#include <utility>
#include <vector>

#include "vdb_madf/base/errors.h"
#include "vdb_madf/exports/mesh_file.h"
#include "vdb_madf/shapes/world_points.h"

namespace vdb_madf::detail {

/// The mesh in world coordinates.
class WorldMesh {
 public:
  WorldMesh(const GrainMesh& mesh, const MeshFileOptions& options, const std::string& path)
      : mesh_(mesh), options_(options) {
    for (const int32_t label : mesh.labels) colors_.push_back(options.colors.colorOf(label));
    const openvdb::math::Transform::ConstPtr transform =
        options.transform ? options.transform : openvdb::math::Transform::createLinearTransform();
    if (!transform->isLinear())
      throw InvalidInput(path + ": the grid's transform is not linear: resample the grid first");
    isMirrored_ = transform->baseMap()->determinant() < 0;
    points_ = worldPoints(mesh, *transform);
  }

  const GrainMesh& mesh() const { return mesh_; }
  size_t grainCount() const { return mesh_.labels.size(); }
  int32_t label(size_t grain) const { return mesh_.labels[grain]; }
  Rgb color(size_t grain) const { return colors_[grain]; }

  const openvdb::Vec3f& point(uint32_t index) const { return points_[index]; }
  /// A mirrored world turns triangles inside out.
  std::array<uint32_t, 3> triangle(uint32_t index) const {
    std::array<uint32_t, 3> result = mesh_.triangles[index];
    if (isMirrored_) std::swap(result[1], result[2]);
    return result;
  }
  std::string unit() const {
    return options_.lengthUnit.empty() ? "voxels (no physical size known)" : options_.lengthUnit;
  }

  /// f(grain, index) for all points or triangles, in order.
  template <typename F>
  void forEachPoint(const F& f) const {
    forEach(mesh_.firstPoint, f);
  }
  template <typename F>
  void forEachTriangle(const F& f) const {
    forEach(mesh_.firstTriangle, f);
  }

 private:
  template <typename F>
  void forEach(const std::vector<uint32_t>& first, const F& f) const {
    for (size_t grain = 0; grain < grainCount(); ++grain)
      for (uint32_t i = first[grain]; i < first[grain + 1]; ++i) f(grain, i);
  }

  const GrainMesh& mesh_;
  const MeshFileOptions& options_;
  std::vector<Rgb> colors_;  ///< of the grains
  std::vector<openvdb::Vec3f> points_;
  bool isMirrored_ = false;
};

}  // namespace vdb_madf::detail
