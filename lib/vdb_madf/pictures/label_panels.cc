// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/pictures/label_panels.h"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <optional>
#include <sstream>
#include <utility>

#include "vdb_madf/grids/grid_metadata.h"
#include "vdb_madf/labels/grain_colors.h"
#include "vdb_madf/labels/interface_voxels.h"
#include "vdb_madf/labels/select_grains.h"

namespace vdb_madf {

namespace {

std::string threeDigits(double value) {
  std::ostringstream text;
  if (value >= 1000)
    text << std::lround(value);  // no 1e+03
  else
    text << std::setprecision(3) << value;
  return text.str();
}

/// How lengths of a sample are written: in one unit, in which its longest edge is 1 or more.
struct LengthUnit {
  std::string name;
  double metres = 1;
};

LengthUnit unitFor(double longestMetres) {
  if (longestMetres >= 1e-3) return {"mm", 1e-3};
  return longestMetres >= 1e-6 ? LengthUnit{"µm", 1e-6} : LengthUnit{"nm", 1e-9};
}

/// The captions of the panels of a box.
class Captions {
 public:
  Captions(const Int32Grid& labels, const CoordBBox& box)
      : box_(box), size_(storedVoxelSize(labels)) {
    if (!size_) return;
    double longest = 0;
    for (int axis = 0; axis < 3; ++axis)
      longest = std::max(longest, box.extents()[axis] * size_->edges()[size_t(axis)]);
    unit_ = unitFor(longest);
  }

  /// "x-y at z = 125 (1.06 mm)"
  std::string of(const SlicePlane& plane) const {
    const std::string names = "xyz";
    std::string text = {names[size_t(plane.right())], '-', names[size_t(plane.down())]};
    text += std::string(" at ") + names[size_t(plane.axis)] + " = " + std::to_string(plane.index);
    if (!size_) return text;
    const double place = plane.index * size_->edges()[size_t(plane.axis)];
    return text + " (" + threeDigits(place / unit_.metres) + " " + unit_.name + ")";
  }

  /// "2.56 × 2.56 × 2.13 mm", or voxels if their size is unknown.
  std::string ofBox() const {
    std::string text;
    for (int axis = 0; axis < 3; ++axis) {
      const int voxels = box_.extents()[axis];
      const double length = size_ ? voxels * size_->edges()[size_t(axis)] / unit_.metres : 0;
      text += (axis ? " × " : "") + (size_ ? threeDigits(length) : std::to_string(voxels));
    }
    return text + " " + (size_ ? unit_.name : "voxels");
  }

 private:
  const CoordBBox box_;
  const std::optional<VoxelSize> size_;
  LengthUnit unit_;
};

/// The part of the labels that the options ask for; null if that is all.
Int32Grid::Ptr shownPart(const Int32Grid& labels, const PanelOptions& options,
                         Interrupter* interrupter) {
  Int32Grid::Ptr shown;
  if (options.interfaces) shown = interfaceVoxels(labels, interrupter);
  if (!options.select.empty()) {
    const Int32Grid::Ptr selected = selectGrains(labels, options.select, interrupter);
    if (!shown) return selected;
    shown->topologyIntersection(*selected);
  }
  return shown;
}

}  // namespace

std::vector<PicturePanel> labelPanels(const Int32Grid& labels, const CoordBBox& box,
                                      const PanelOptions& options, Interrupter* interrupter) {
  const GrainColors colors = grainColors(labels, interrupter);
  const Int32Grid::Ptr shown = shownPart(labels, options, interrupter);
  const Captions captions(labels, box);
  std::vector<PicturePanel> panels;
  if (options.slices) {
    const SliceOptions how{options.edge, options.planes, shown.get(), options.gray};
    LabelSlices slices = labelSlices(labels, box, colors, how, interrupter);
    for (size_t i = 0; i < slices.pictures.size(); ++i)
      panels.push_back({std::move(slices.pictures[i]), captions.of(slices.planes[i]),
                        slices.voxelsPerPixel, true});
  }
  if (options.view) {
    ViewOptions direction = options.direction;
    direction.edge = options.edge;
    direction.box = options.axes;
    const Int32Grid& seen = shown ? *shown : labels;
    GrainView view = viewGrains(seen, box, colors, direction, interrupter);
    const bool isSecond = panels.size() == 3;
    panels.insert(isSecond ? panels.begin() + 1 : panels.end(),
                  {std::move(view.picture), captions.ofBox(), view.voxelsPerPixel, false});
  }
  return panels;
}

}  // namespace vdb_madf
