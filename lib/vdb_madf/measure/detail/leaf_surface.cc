// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/measure/detail/leaf_surface.h"

#include <algorithm>
#include <cmath>

#include "vdb_madf/leaves/detail/leaf_mask.h"

namespace vdb_madf::detail {

namespace {

// Twice the radii in which faces make a normal. Chosen on planes, spheres and discs: a free surface
// is curved, and 2.5 voxels are enough; interfaces are flat but for their rims.
constexpr int kFreeReach = 5;    // 2.5 voxels
constexpr int kSharedReach = 8;  // 4 voxels
// What the window allows (drawn in leaf_surface.h).
constexpr int kMostFreeReach = 15, kMostSharedReach = 12;

/// All x of the window.
constexpr WindowRange kAll{WindowRows::kBegin, WindowRows::kEnd};

/// How far apart two voxels of two grains are that make a pair.
constexpr std::array<int, 3> kSteps = {1, 2, 4};

/// In voxels: a rim that widens by this much or more between pairs 2 and 4 apart lies in a groove.
/// Chosen on discs.
constexpr double kGroove = 0.4;

/// The lower voxels of all faces in reach of something centered from `first` / 2 to `last` / 2.
FaceRange rangeOf(const NormalReach& reach, int first, int last) {
  FaceRange range;
  for (size_t axis = 0; axis < 3; ++axis) {
    const int radius = reach.radius(int(axis));
    // Centers, doubled, are those of lower voxels along the face, and 1 more across it.
    const int least = first - radius + 1, most = last + radius - 1;
    range.begin[axis] = (least - 1) >> 1;
    range.last[axis] = most >> 1;
  }
  return range;
}

/// The voxels that lie 1, 2 or 4 above one of a set in the leaf.
void reachUpwards(const WindowRows& set, WindowRows& reached) {
  reached.rows.fill(0);
  for (int x = 0; x < 8; ++x) {
    for (int y = 0; y < 8; ++y) {
      const uint32_t row = set.row(x, y) & 0xff00u;
      for (const int step : kSteps) {
        reached.line(x + step)[y - WindowRows::kBegin] |= row;
        reached.line(x)[y + step - WindowRows::kBegin] |= row;
        reached.line(x)[y - WindowRows::kBegin] |= row << step;
      }
    }
  }
}

}  // namespace

LeafSurface::LeafSurface(const LabelLeaves& labels, const std::optional<Domain>& domain,
                         const VoxelShape& voxel)
    : labels_(&labels),
      window_(labels, voxel.isCube() ? WindowRange() : kAll),
      domain_(domain),
      freeReach_(kFreeReach, kMostFreeReach, voxel),
      sharedReach_(kSharedReach, kMostSharedReach, voxel),
      freeRange_(rangeOf(freeReach_, -1, 15)),
      sharedRange_(rangeOf(sharedReach_, 0, 18)),
      faces_(voxel) {}

/// Whether any of the voxels around the leaf lie outside the domain.
bool LeafSurface::findOutside() {
  const CoordBBox window(origin_.offsetBy(window_.range().begin),
                         origin_.offsetBy(window_.range().end - 1));
  if (domain_->isBox() && domain_->box().isInside(window)) return false;
  outside_.rows.fill(0);
  bool any = false;
  for (int side = 0; side < 27; ++side) {
    const LeafIndex::Mask beyond = without(kFullMask, insideMask(*domain_, around(origin_, side)));
    if (!anyVoxel(beyond)) continue;
    addLeaf(beyond, side, window_.range(), outside_);
    any = true;
  }
  return any;
}

void LeafSurface::findBackground() {
  for (size_t i = 0; i < labelled_.rows.size(); ++i) background_.rows[i] = ~labelled_.rows[i];
  atBorder_ = domain_ && findOutside();
  if (!atBorder_) return;
  for (size_t i = 0; i < outside_.rows.size(); ++i) background_.rows[i] &= ~outside_.rows[i];
}

void LeafSurface::measureFree(int32_t label) {
  free_.emplace_back().label = label;
  targets_.clear();
  for (int side = 0; side < 6; ++side)
    addTargets(own_, background_, side >> 1, side & 1 ? -1 : 1, side, targets_);
  if (!targets_.empty()) {
    faces_.collect(own_, background_, freeRange_);
    free_.back().area =
        faces_.area(targets_.data(), targets_.data() + targets_.size(), freeReach_, true);
  }
  if (!atBorder_) return;
  for (int side = 0; side < 6; ++side) {
    targets_.clear();
    addTargets(own_, outside_, side >> 1, side & 1 ? -1 : 1, side, targets_);
    if (targets_.empty()) continue;
    CutFaces& cut = free_.back().cuts.emplace_back();
    cut.side = side;
    cut.faces = int64_t(targets_.size());
    for (const SurfaceTarget& target : targets_)
      for (size_t i = 0; i < 3; ++i) cut.sum[i] += target.center[i];
  }
}

/// All bonds with a voxel of a label below one of another, near enough for a pair.
void LeafSurface::measureShared(int32_t label) {
  reachUpwards(own_, near_);
  for (size_t i = 0; i < near_.rows.size(); ++i) near_.rows[i] &= labelled_.rows[i] & ~own_.rows[i];
  for (int x = 0; x < 12; ++x) {
    for (int y = 0; y < 12; ++y) {
      while (const uint32_t row = near_.row(x, y)) {
        const int32_t other = window_.label(x, y, __builtin_ctz(row) - 8);
        window_.labelled(other, other_);
        for (size_t i = 0; i < near_.rows.size(); ++i) near_.rows[i] &= ~other_.rows[i];
        measureBond(label, other);
      }
    }
  }
}

void LeafSurface::measureBond(int32_t label, int32_t other) {
  const auto bond = std::minmax(label, other);
  if (std::find(bonds_.begin(), bonds_.end(), std::pair<int32_t, int32_t>(bond)) != bonds_.end())
    return;
  bonds_.emplace_back(bond);
  const WindowRows& first = label < other ? own_ : other_;
  const WindowRows& second = label < other ? other_ : own_;
  faces_.collect(first, second, sharedRange_);
  Shared shared;
  shared.first = bond.first;
  shared.second = bond.second;
  for (size_t i = 0; i < kSteps.size(); ++i) {
    targets_.clear();
    for (int axis = 0; axis < 3; ++axis) {
      addTargets(first, second, axis, kSteps[i], 2 * axis, targets_);
      addTargets(second, first, axis, kSteps[i], 2 * axis + 1, targets_);
    }
    shared.areas[i] =
        faces_.area(targets_.data(), targets_.data() + targets_.size(), sharedReach_, false);
    if (kSteps[i] > 1) continue;
    for (const SurfaceTarget& target : targets_) {
      InterfaceFace face;
      // Halves are rounded down: the lower voxel.
      for (int k = 0; k < 3; ++k) face.lower[k] = origin_[k] + (target.center[size_t(k)] >> 1);
      face.axis = int8_t(target.side >> 1);
      face.sign = int8_t(target.side & 1 ? -1 : 1);
      shared.faces.push_back(face);
    }
  }
  if (!shared.faces.empty() || shared.areas[1] || shared.areas[2])
    shared_.push_back(std::move(shared));
}

void LeafSurface::measure(size_t leaf) {
  free_.clear();
  shared_.clear();
  bonds_.clear();
  origin_ = labels_->index().origin(leaf);
  window_.moveTo(leaf);
  window_.labelled(labelled_);
  findBackground();
  for (const LabelPart& part : labels_->parts(leaf)) {
    window_.labelled(part.label, own_);
    measureFree(part.label);
    measureShared(part.label);
  }
}

void LeafSurface::join(int32_t kept, int32_t gone) {
  free_.clear();
  shared_.clear();
  window_.join(kept, gone);
  window_.labelled(kept, own_);
  measureFree(kept);
  std::vector<int32_t> others;
  std::vector<std::pair<int32_t, int32_t>> rest;
  for (const auto& bond : bonds_) {
    const bool first = bond.first == kept || bond.first == gone;
    const bool second = bond.second == kept || bond.second == gone;
    if (!first && !second)
      rest.push_back(bond);
    else if (first != second)
      others.push_back(first ? bond.second : bond.first);
  }
  bonds_.swap(rest);
  for (const int32_t other : others) {
    window_.labelled(other, other_);
    measureBond(kept, other);  // once: it knows those that it has measured
  }
}

double bondArea(const std::array<int64_t, 3>& areas, const VoxelShape& voxel) {
  const double meanFace = voxel.meanEdge() * voxel.meanEdge();
  const double unit = kAreaUnit * meanFace;
  const double one = double(areas[0]) / unit, two = double(areas[1]) / (2 * unit),
               four = double(areas[2]) / (4 * unit);
  // Two more voxels between the pairs widen the rim of a disc by so much.
  const double widening = (four - two) / (2 * std::sqrt(M_PI * std::max(two, 1.0)));
  const double groove = std::clamp(widening / kGroove, 0.0, 1.0);
  const double atZero = (1 - groove) * (2 * one - two) + groove * (2 * two - four);
  return meanFace * std::clamp(atZero, 0.25 * one, 1.1 * one);
}

}  // namespace vdb_madf::detail
