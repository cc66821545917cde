// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/grids/domain.h"

#include <string>

#include "vdb_madf/base/errors.h"
#include "vdb_madf/base/limits.h"
#include "vdb_madf/grids/detail/mask_sets.h"

namespace vdb_madf {

namespace {

__int128 volumeOf(const CoordBBox& box) {
  __int128 volume = box.empty() ? 0 : 1;
  for (int axis = 0; axis < 3; ++axis) volume *= int64_t(box.max()[axis]) - box.min()[axis] + 1;
  return volume;
}

}  // namespace

Domain::Domain(const MaskTree& region) {
  if (!region.evalActiveVoxelBoundingBox(box_))
    throw InvalidInput(
        "the region, as it was cropped, holds no voxel: give one that covers the sample");
  for (int axis = 0; axis < 3; ++axis)
    if (box_.min()[axis] < -kMaxCoordinate || box_.max()[axis] > kMaxCoordinate)
      throw InvalidInput("the region has coordinates beyond +-" + std::to_string(kMaxCoordinate));
  if (volumeOf(box_) == __int128(region.activeVoxelCount())) return;
  auto copy = std::make_shared<MaskTree>(region);
  copy->prune();
  copy->root().eraseBackgroundTiles();
  region_ = copy;
}

__int128 Domain::voxelCount() const {
  return region_ ? __int128(region_->activeVoxelCount()) : volumeOf(box_);
}

std::optional<int> Domain::flatAxis() const {
  for (int axis = 0; axis < 3; ++axis)
    if (box_.min()[axis] == box_.max()[axis]) return axis;
  return std::nullopt;
}

bool Domain::isInside(const Coord& voxel) const {
  return region_ ? region_->isValueOn(voxel) : box_.isInside(voxel);
}

Domain Domain::within(const Domain& other) const {
  if (region_) {
    MaskTree inside(*region_);
    if (other.region_)
      detail::intersect(inside, *other.region_);
    else
      inside.clip(other.box_);
    return Domain(inside);
  }
  if (other.region_) return other.within(*this);
  CoordBBox both = box_;
  both.intersect(other.box_);
  return both.empty() ? Domain(MaskTree()) : Domain(both);  // the former says that it is empty
}

bool operator==(const Domain& a, const Domain& b) {
  if (a.box_ != b.box_ || a.isBox() != b.isBox()) return false;
  return a.region_ == b.region_ || a.region_->hasSameTopology(*b.region_);
}

}  // namespace vdb_madf
