// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/pictures/label_slices.h"

#include <algorithm>

#include "vdb_madf/base/errors.h"

namespace vdb_madf {

namespace {

constexpr Rgb kBackground{18, 20, 26};

/// Either is 1.
struct Scale {
  int pixelsPerVoxel = 1;  ///< small samples
  int voxelsPerPixel = 1;  ///< large ones

  Scale(const Coord& size, int edge) {
    const int longest = std::max({size.x(), size.y(), size.z()});
    if (longest <= edge)
      pixelsPerVoxel = edge / longest;
    else
      voxelsPerPixel = (longest + edge - 1) / edge;
  }
  int pixels(int voxels) const {
    return (voxels * pixelsPerVoxel + voxelsPerPixel - 1) / voxelsPerPixel;
  }
};

/// The plane where one coordinate is in the middle; `right` and `down` are the other axes.
Picture paintSlice(const Int32Grid& labels, const CoordBBox& box, const GrainColors& colors,
                   const Scale& scale, int right, int down) {
  const Coord size = box.extents();
  Picture picture(scale.pixels(size[right]), scale.pixels(size[down]), kBackground);
  const auto accessor = labels.getConstAccessor();
  const int fixed = 3 - right - down;
  Coord p;
  p[fixed] = box.min()[fixed] + (size[fixed] - 1) / 2;
  for (int y = 0; y < picture.height; ++y) {
    const int row = y / scale.pixelsPerVoxel * scale.voxelsPerPixel;
    p[down] = down == 2 ? box.max().z() - row : box.min()[down] + row;  // z is up
    for (int x = 0; x < picture.width; ++x) {
      p[right] = box.min()[right] + x / scale.pixelsPerVoxel * scale.voxelsPerPixel;
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
  const Scale scale(box.extents(), edge);
  const auto paint = [&](int right, int down) {
    return paintSlice(labels, box, colors, scale, right, down);
  };
  return {{paint(0, 1), paint(0, 2), paint(1, 2)},
          double(scale.voxelsPerPixel) / scale.pixelsPerVoxel};
}

}  // namespace vdb_madf
