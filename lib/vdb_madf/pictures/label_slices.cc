// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/pictures/label_slices.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "vdb_madf/base/detail/parallel.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/grids/detail/world_transform.h"

namespace vdb_madf {

namespace {

constexpr Rgb kBackground{243, 244, 246}, kPale{206, 209, 214};
constexpr size_t kSliceRowGrain = 16;
constexpr double kOutline = 1 / 300.0;  ///< of the edge: width of an outline, on each side
/// Lines within an outline, half as wide: one of them stands out on any gray.
constexpr Rgb kDarkLine{25, 25, 25}, kLightLine{235, 235, 235};

/// Goes between the pixels of pictures and the voxels of a box.
class Scale {
 public:
  /// @param edges of a voxel; the shortest is 1
  Scale(const Coord& size, const openvdb::Vec3d& edges, int edge) : edges_(edges) {
    const openvdb::Vec3d lengths = edges * size.asVec3d();
    perPixel_ = std::max({lengths[0], lengths[1], lengths[2]}) / edge;
  }
  double perPixel() const { return perPixel_; }
  int pixels(int voxels, int axis) const {
    return std::max(1, int(std::ceil(voxels * edges_[axis] / perPixel_ - 1e-6)));
  }
  /// The one of `voxels` along the axis at a place in pixels.
  int voxel(double place, int voxels, int axis) const {
    return std::min(int(place * perPixel_ / edges_[axis]), voxels - 1);
  }

 private:
  openvdb::Vec3d edges_;
  double perPixel_ = 1;
};

/// Paints a plane in bands of rows. Each pixel is the mean of fine ones.
class PlanePainter {
 public:
  PlanePainter(const Int32Grid& labels, const CoordBBox& box, const GrainColors& colors,
               const Scale& scale, const SlicePlane& plane, const SliceOptions& options,
               const GrayPlane* gray)
      : labels_(labels),
        box_(box),
        colors_(colors),
        plane_(plane),
        shown_(options.shown),
        gray_(gray),
        right_(plane.right()),
        down_(plane.down()),
        fine_(gray ? 2 : 3),
        outline_(gray ? std::max(fine_, int(std::lround(fine_ * options.edge * kOutline))) : 0),
        line_((outline_ + 1) / 2),
        picture_(scale.pixels(box.extents()[right_], right_),
                 scale.pixels(box.extents()[down_], down_), kBackground) {
    for (int x = 0; x < picture_.width * fine_; ++x)
      columns_.push_back(scale.voxel((x + 0.5) / fine_, box.extents()[right_], right_));
    for (int y = 0; y < picture_.height * fine_; ++y)
      rows_.push_back(scale.voxel((y + 0.5) / fine_, box.extents()[down_], down_));
  }

  Picture paint(Interrupter* interrupter) {
    detail::parallelFor(size_t(picture_.height), kSliceRowGrain, interrupter,
                        [&](size_t begin, size_t end) { paintRows(int(begin), int(end)); });
    return std::move(picture_);
  }

 private:
  /// Positive: the label of a grain in its color; negative: of a pale one; 0: none.
  using Row = std::vector<int32_t>;

  /// Counted from the upper edge of the picture.
  int voxelRow(int fineRow) const { return rows_[size_t(fineRow)]; }

  Row readRow(int voxelRow) const {
    const auto labels = labels_.getConstUnsafeAccessor();
    const auto shown = (shown_ ? *shown_ : labels_).getConstUnsafeAccessor();
    Coord p;
    p[plane_.axis] = plane_.index;
    p[down_] = down_ == 2 ? box_.max().z() - voxelRow : box_.min()[down_] + voxelRow;  // z is up
    Row row(size_t(box_.extents()[right_]), 0);
    for (size_t i = 0; i < row.size(); ++i) {
      p[right_] = box_.min()[right_] + int(i);
      int32_t label = 0;
      if (shown.probeValue(p, label) && label > 0)
        row[i] = label;
      else if (shown_ && labels.probeValue(p, label) && label > 0)
        row[i] = -label;
    }
    return row;
  }

  void paintRows(int begin, int end) {
    const int reach = outline_ + 2 * line_, first = std::max(0, begin * fine_ - reach),
              last = std::min(picture_.height * fine_, end * fine_ + reach) - 1;
    // The rows of voxels that the fine rows show; many show the same.
    const int firstVoxel = voxelRow(first);
    std::vector<Row> rows;
    for (int row = firstVoxel; row <= voxelRow(last); ++row) rows.push_back(readRow(row));
    const auto labelAt = [&](int x, int y) {
      const int column = columns_[size_t(std::clamp(x, 0, int(columns_.size()) - 1))];
      return rows[size_t(voxelRow(std::clamp(y, first, last)) - firstVoxel)][size_t(column)];
    };
    for (int y = begin; y < end; ++y)
      for (int x = 0; x < picture_.width; ++x) picture_.at(x, y) = meanColor(x, y, labelAt);
  }

  template <typename LabelAt>
  Rgb meanColor(int x, int y, const LabelAt& labelAt) const {
    std::array<int, 3> sum{};
    int32_t last = 0;
    Rgb color = kBackground;
    for (int j = y * fine_; j < (y + 1) * fine_; ++j)
      for (int i = x * fine_; i < (x + 1) * fine_; ++i) {
        const int32_t label = labelAt(i, j);
        if (gray_) {
          color = outlined(i, j, label, labelAt);
        } else if (label != last) {
          color = colorOf(label);
          last = label;
        }
        for (size_t channel = 0; channel < 3; ++channel) sum[channel] += color[channel];
      }
    Rgb mean{};
    const int count = fine_ * fine_;
    for (size_t channel = 0; channel < 3; ++channel)
      mean[channel] = uint8_t((sum[channel] + count / 2) / count);
    return mean;
  }

  Rgb colorOf(int32_t label) const {
    return label > 0 ? colors_.colorOf(label) : label < 0 ? kPale : kBackground;
  }

  /// Inwards from where a grain ends that has its color: that, a dark line and a light one.
  template <typename LabelAt>
  Rgb outlined(int x, int y, int32_t label, const LabelAt& labelAt) const {
    const Rgb gray = grayAt(x, y);
    if (label <= 0 || !isNearEnd(x, y, label, outline_ + 2 * line_, labelAt)) return gray;
    if (isNearEnd(x, y, label, outline_, labelAt)) return colorOf(label);
    return isNearEnd(x, y, label, outline_ + line_, labelAt) ? kDarkLine : kLightLine;
  }

  template <typename LabelAt>
  bool isNearEnd(int x, int y, int32_t label, int reach, const LabelAt& labelAt) const {
    const int slanted = int(std::lround(reach * 0.7));
    for (const auto& [dx, dy] : {std::pair<int, int>{reach, 0},
                                 {-reach, 0},
                                 {0, reach},
                                 {0, -reach},
                                 {slanted, slanted},
                                 {slanted, -slanted},
                                 {-slanted, slanted},
                                 {-slanted, -slanted}})
      if (labelAt(x + dx, y + dy) != label) return true;
    return false;
  }

  Rgb grayAt(int x, int y) const {
    const int row = voxelRow(y);
    const int from = down_ == 2 ? gray_->height - 1 - row : row;
    const uint8_t value =
        gray_->values[size_t(from) * size_t(gray_->width) + size_t(columns_[size_t(x)])];
    return {value, value, value};
  }

  const Int32Grid& labels_;
  const CoordBBox box_;
  const GrainColors& colors_;
  const SlicePlane plane_;
  const Int32Grid* shown_;
  const GrayPlane* gray_;
  const int right_, down_, fine_, outline_, line_;  ///< outlines in fine pixels
  Picture picture_;
  std::vector<int> columns_, rows_;  ///< the voxel of each fine column, fine row
};

void check(const CoordBBox& box, const std::vector<SlicePlane>& planes,
           const std::vector<GrayPlane>& gray) {
  for (const SlicePlane& plane : planes) {
    const std::string axis(1, "xyz"[plane.axis]);
    if (plane.index < box.min()[plane.axis] || plane.index > box.max()[plane.axis])
      throw InvalidInput(fmt::format("there is no slice {} = {}: {} goes from {} to {}", axis,
                                     plane.index, axis, box.min()[plane.axis],
                                     box.max()[plane.axis]));
  }
  if (!gray.empty() && gray.size() != planes.size())
    throw InvalidInput("slices: gray values are wanted for each plane or for none");
  for (size_t i = 0; i < gray.size(); ++i) {
    const int width = box.extents()[planes[i].right()], height = box.extents()[planes[i].down()];
    if (gray[i].width != width || gray[i].height != height ||
        gray[i].values.size() != size_t(width) * size_t(height))
      throw InvalidInput("slices: the gray values do not fit the box");
  }
}

}  // namespace

std::vector<SlicePlane> middlePlanes(const CoordBBox& box) {
  std::vector<SlicePlane> planes;
  for (const int axis : {2, 1, 0})
    planes.push_back({axis, box.min()[axis] + (box.extents()[axis] - 1) / 2});
  return planes;
}

LabelSlices labelSlices(const Int32Grid& labels, const CoordBBox& box, const GrainColors& colors,
                        const SliceOptions& options, Interrupter* interrupter) {
  if (box.empty()) throw InvalidInput("slices: the box is empty");
  if (options.edge < 1) throw InvalidInput("slices: the edge must have 1 pixel or more");
  const Scale scale(box.extents(), detail::proportions(labels.transform()), options.edge);
  LabelSlices slices;
  slices.planes = options.planes.empty() ? middlePlanes(box) : options.planes;
  slices.voxelsPerPixel = scale.perPixel();
  check(box, slices.planes, options.gray);
  for (size_t i = 0; i < slices.planes.size(); ++i) {
    const GrayPlane* const gray = options.gray.empty() ? nullptr : &options.gray[i];
    slices.pictures.push_back(
        PlanePainter(labels, box, colors, scale, slices.planes[i], options, gray)
            .paint(interrupter));
  }
  return slices;
}

}  // namespace vdb_madf
