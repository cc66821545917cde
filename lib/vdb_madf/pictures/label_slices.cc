// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/pictures/label_slices.h"

#include <algorithm>
#include <cmath>

#include "vdb_madf/base/errors.h"
#include "vdb_madf/grids/detail/world_transform.h"

namespace vdb_madf {

namespace {

constexpr Rgb kBackground{18, 20, 26};

/// Either number is 1, the other whole: small samples have pixels for each shortest edge of a voxel,
/// large ones such edges for each pixel.
class Scale {
 public:
  /// @param edges of a voxel; the shortest is 1
  Scale(const Coord& size, const openvdb::Vec3d& edges, int edge) : edges_(edges) {
    const openvdb::Vec3d lengths = edges * size.asVec3d();
    const double longest = std::max({lengths[0], lengths[1], lengths[2]});
    if (longest <= edge)
      pixelsPerEdge_ = std::floor(edge / longest);
    else
      edgesPerPixel_ = std::ceil(longest / edge);
  }
  double edgesPerPixel() const { return edgesPerPixel_ / pixelsPerEdge_; }
  int pixels(int voxels, int axis) const {
    return int(std::ceil(voxels * edges_[axis] * pixelsPerEdge_ / edgesPerPixel_));
  }
  /// Of `voxels` along the axis, the one at the beginning of the pixel.
  int voxel(int pixel, int voxels, int axis) const {
    return std::min(int(pixel / pixelsPerEdge_ * edgesPerPixel_ / edges_[axis]), voxels - 1);
  }

 private:
  openvdb::Vec3d edges_;
  double pixelsPerEdge_ = 1, edgesPerPixel_ = 1;
};

/// The plane where one coordinate is in the middle; `right` and `down` are the other axes.
Picture paintSlice(const Int32Grid& labels, const CoordBBox& box, const GrainColors& colors,
                   const Scale& scale, int right, int down) {
  const Coord size = box.extents();
  Picture picture(scale.pixels(size[right], right), scale.pixels(size[down], down), kBackground);
  const auto accessor = labels.getConstAccessor();
  const int fixed = 3 - right - down;
  Coord p;
  p[fixed] = box.min()[fixed] + (size[fixed] - 1) / 2;
  for (int y = 0; y < picture.height; ++y) {
    const int row = scale.voxel(y, size[down], down);
    p[down] = down == 2 ? box.max().z() - row : box.min()[down] + row;  // z is up
    for (int x = 0; x < picture.width; ++x) {
      p[right] = box.min()[right] + scale.voxel(x, size[right], right);
      int32_t label = 0;
      if (accessor.probeValue(p, label) && label > 0) picture.at(x, y) = colors.colorOf(label);
    }
  }
  return picture;
}

}  // namespace

LabelSlices middleSlices(const Int32Grid& labels, const CoordBBox& box, const GrainColors& colors,
                         int edge) {
  if (box.empty()) throw InvalidInput("slices: the box is empty");
  if (edge < 1) throw InvalidInput("slices: the edge must have 1 pixel or more");
  const Scale scale(box.extents(), detail::proportions(labels.transform()), edge);
  const auto paint = [&](int right, int down) {
    return paintSlice(labels, box, colors, scale, right, down);
  };
  return {{paint(0, 1), paint(0, 2), paint(1, 2)}, scale.edgesPerPixel()};
}

}  // namespace vdb_madf
