// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <algorithm>
#include <array>
#include <vector>

#include "vdb_madf/grids/grid_types.h"

namespace vdb_madf::detail {

/// The squared distances of the voxels of a block to the points, triangles and edges that are
/// added, each measured for the voxels that it can be nearest to; see mesh_distance.h.
class BlockDistances {
 public:
  /// Voxels along an axis of a block, at most: its distances stay in a core's cache.
  static constexpr int kMaxSide = 64;

  /// \p reach: in voxels; what lies farther has this distance
  BlockDistances(const CoordBBox& box, float reach);

  void addPoint(const openvdb::Vec3f& point);
  void addTriangle(const openvdb::Vec3d& a, const openvdb::Vec3d& b, const openvdb::Vec3d& c);
  /// Adds the edge from a to b, in the direction of the first of two triangles with these unit
  /// normals (0: the triangle has no area).
  void addEdge(const openvdb::Vec3d& a, const openvdb::Vec3d& b, openvdb::Vec3d one,
               openvdb::Vec3d other);

  std::vector<float> squares() const;  ///< z fastest

 private:
  static constexpr double kFar = 1e30;
  static constexpr size_t kMaxWidth = 40;

  struct Range {
    double low, high;

    void include(double value) {
      low = std::min(low, value);
      high = std::max(high, value);
    }
  };

  size_t place(int x, int y, int z) const {
    return size_t((x - box_.min().x()) * layerLength_ + (y - box_.min().y()) * rowLength_ + z -
                  box_.min().z() + beside_);
  }
  /// A box around the wedge of edge ab: all points within reach of the edge whose offset from it
  /// lies between the directions `step` and `otherStep`.
  std::array<Range, 3> boxOfWedge(const openvdb::Vec3d& a, const openvdb::Vec3d& b,
                                  const openvdb::Vec3d& step,
                                  const openvdb::Vec3d& otherStep) const;
  /// f(w, u, v, square) for voxels of the block, by their places along the axis W and the two after
  /// it: those of rectangleOf(w) in each slice w of a range.
  template <int kW, typename RectangleOf, typename F>
  void forEachIn(const Range& heights, const RectangleOf& rectangleOf, const F& f);

  CoordBBox box_;
  double reach_;
  int steps_, width_, beside_, rowLength_, layerLength_;
  std::vector<float> squares_;  ///< with voxels more on both sides along z, which nobody reads
};

}  // namespace vdb_madf::detail
