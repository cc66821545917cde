// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/pictures/label_panels.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>

#include "vdb_madf/base/detail/text.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/grids/grid_metadata.h"
#include "vdb_madf/labels/detail/rimmed_slabs.h"
#include "vdb_madf/labels/grain_colors.h"
#include "vdb_madf/labels/interface_voxels.h"
#include "vdb_madf/labels/select_grains.h"

namespace vdb_madf {

namespace {

std::string threeDigits(double value) {
  return value >= 1000 ? std::to_string(std::lround(value))  // no 1e+03
                       : detail::generalDecimal(value, 3);
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
  Captions(const Int32Grid& labels, const CoordBBox& box) : size_(storedVoxelSize(labels)) {
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
  std::string of(const CoordBBox& box) const {
    std::string text;
    for (int axis = 0; axis < 3; ++axis) {
      const int voxels = box.extents()[axis];
      const double length = size_ ? voxels * size_->edges()[size_t(axis)] / unit_.metres : 0;
      text += (axis ? " × " : "") + (size_ ? threeDigits(length) : std::to_string(voxels));
    }
    return text + " " + (size_ ? unit_.name : "voxels");
  }

 private:
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

CoordBBox frameOf(const PanelOptions& options, const CoordBBox& box) {
  return options.frame.empty() ? box : options.frame;
}

/// The panels of labels of which some are shown (null: all). view(how): as viewGrains().
template <typename View>
std::vector<PicturePanel> panelsOf(const Int32Grid& labels, const Int32Grid* shown,
                                   const CoordBBox& box, const GrainColors& colors,
                                   const PanelOptions& options, const View& view,
                                   Interrupter* interrupter) {
  const Captions captions(labels, box);
  std::vector<PicturePanel> panels;
  if (options.slices) {
    const SliceOptions how{options.edge, options.planes, shown, options.gray};
    LabelSlices slices = labelSlices(labels, box, colors, how, interrupter);
    for (size_t i = 0; i < slices.pictures.size(); ++i)
      panels.push_back({std::move(slices.pictures[i]), captions.of(slices.planes[i]),
                        slices.voxelsPerPixel, true});
  }
  if (options.view) {
    ViewOptions direction = options.direction;
    direction.edge = options.edge;
    direction.box = options.axes;
    direction.surfaces = true;
    GrainView seen = view(direction);
    const bool isSecond = panels.size() == 3;
    panels.insert(
        isSecond ? panels.begin() + 1 : panels.end(),
        {std::move(seen.picture), captions.of(frameOf(options, box)), seen.voxelsPerPixel, false});
  }
  return panels;
}

/// What pictures need of labels in slabs.
class SlabParts {
 public:
  SlabParts(const LabelSlabs& labels, const CoordBBox& box, const PanelOptions& options)
      : labels_(labels),
        options_(options),
        planes_(options.planes.empty() ? middlePlanes(box) : options.planes),
        selected_(options.select),
        inPlanes_(Int32Grid::create(*labels.about)),
        shownInPlanes_(Int32Grid::create(*labels.about)),
        object_(MaskGrid::create()) {
    std::sort(selected_.begin(), selected_.end());
    object_->setTransform(labels.about->transform().copy());
  }

  /// Goes through all slabs. @throw InvalidInput if a label that is selected has no voxel
  void gather(Interrupter* interrupter) {
    GrainColoring coloring;
    detail::RimmedSlabs slabs(labels_);
    while (slabs.next(interrupter)) {
      coloring.add(slabs.labels(), interrupter);
      const Int32Grid::ConstPtr shown = shownPart(slabs.labels(), interrupter);
      for (auto leaf = slabs.labels().tree().cbeginLeaf(); leaf; ++leaf)
        if (slabs.isOwn(leaf->origin())) addToPlanes(*leaf, *inPlanes_);
      for (auto leaf = (shown ? *shown : slabs.labels()).tree().cbeginLeaf(); leaf; ++leaf) {
        if (!slabs.isOwn(leaf->origin())) continue;
        if (shown) addToPlanes(*leaf, *shownInPlanes_);
        if (options_.view) addToObject(*leaf);
      }
    }
    colors_ = coloring.colors();
    for (const int32_t label : selected_)
      if (!std::binary_search(colors_.labels.begin(), colors_.labels.end(), label))
        throw InvalidInput("there is no grain " + std::to_string(label));
  }

  const GrainColors& colors() const { return colors_; }
  const Int32Grid& inPlanes() const { return *inPlanes_; }
  const Int32Grid* shownInPlanes() const { return isPart() ? shownInPlanes_.get() : nullptr; }
  const MaskGrid::Ptr& object() const { return object_; }

  /// The labels of some leaf nodes, ascending.
  Int32Grid::Ptr labelsOf(const std::vector<Coord>& leaves, Interrupter* interrupter) const {
    const Int32Grid::Ptr found = Int32Grid::create(*labels_.about);
    for (size_t s = 0; s < labels_.slabCount(); ++s) {
      Int32Grid::Ptr slab;
      for (const Coord& origin : leaves) {
        if (origin.z() < labels_.cuts[s] || origin.z() >= labels_.cuts[s + 1]) continue;
        if (!slab) {
          slab = labels_.read(s, interrupter);
          slab->tree().voxelizeActiveTiles();
        }
        if (const Leaf* const leaf = slab->tree().probeConstLeaf(origin))
          found->tree().addLeaf(new Leaf(*leaf));
      }
    }
    return found;
  }

 private:
  using Leaf = Int32Tree::LeafNodeType;
  using MaskLeaf = MaskTree::LeafNodeType;

  bool isPart() const { return options_.interfaces || !selected_.empty(); }

  /// What is shown of the leaves of a slab and beside it. Null: all.
  Int32Grid::Ptr shownPart(const Int32Grid& labels, Interrupter* interrupter) const {
    if (!isPart()) return nullptr;
    Int32Grid::Ptr shown =
        options_.interfaces ? interfaceVoxels(labels, interrupter) : labels.deepCopy();
    if (selected_.empty()) return shown;
    for (auto leaf = shown->tree().beginLeaf(); leaf; ++leaf)
      for (auto voxel = leaf->beginValueOn(); voxel; ++voxel)
        if (!std::binary_search(selected_.begin(), selected_.end(), *voxel)) voxel.setValueOff();
    return shown;
  }

  void addToPlanes(const Leaf& leaf, Int32Grid& grid) const {
    if (!options_.slices) return;
    for (const SlicePlane& plane : planes_) {
      const int at = plane.index - leaf.origin()[plane.axis];
      if (at < 0 || at >= 8) continue;
      grid.tree().addLeaf(new Leaf(leaf));
      return;
    }
  }

  void addToObject(const Leaf& leaf) {
    MaskLeaf* const mask = object_->tree().touchLeaf(leaf.origin());
    for (auto voxel = leaf.cbeginValueOn(); voxel; ++voxel)
      if (*voxel > 0) mask->setValueOn(voxel.pos());
  }

  const LabelSlabs& labels_;
  const PanelOptions& options_;
  const std::vector<SlicePlane> planes_;
  std::vector<int32_t> selected_;
  GrainColors colors_;
  Int32Grid::Ptr inPlanes_, shownInPlanes_;
  MaskGrid::Ptr object_;
};

}  // namespace

std::vector<PicturePanel> labelPanels(const Int32Grid& labels, const CoordBBox& box,
                                      const PanelOptions& options, Interrupter* interrupter) {
  const GrainColors colors = options.colors ? *options.colors : grainColors(labels, interrupter);
  const Int32Grid::Ptr shown = shownPart(labels, options, interrupter);
  const auto view = [&](const ViewOptions& how) {
    return viewGrains(shown ? *shown : labels, frameOf(options, box), colors, how, interrupter);
  };
  return panelsOf(labels, shown.get(), box, colors, options, view, interrupter);
}

std::vector<PicturePanel> labelPanels(const LabelSlabs& labels, const CoordBBox& box,
                                      const PanelOptions& options, Interrupter* interrupter) {
  SlabParts parts(labels, box, options);
  parts.gather(interrupter);
  const GrainColors& colors = options.colors ? *options.colors : parts.colors();
  const auto view = [&](const ViewOptions& how) {
    const CoordBBox frame = frameOf(options, box);
    const std::vector<Coord> leaves = seenLeaves(parts.object(), frame, how, interrupter);
    return viewGrains(parts.object(), *parts.labelsOf(leaves, interrupter), frame, colors, how,
                      interrupter);
  };
  return panelsOf(parts.inPlanes(), parts.shownInPlanes(), box, colors, options, view, interrupter);
}

}  // namespace vdb_madf
