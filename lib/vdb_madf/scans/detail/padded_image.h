// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <optional>
#include <utility>
#include <vector>

#include "vdb_madf/grids/grid_types.h"
#include "vdb_madf/images/image.h"

namespace vdb_madf::detail {

/// Reads another image, and sees its padding: the voxels between an end of a row and the first that
/// has another value than the four corners of all slices, as around a round field of view. It
/// remembers slices no longer than filters of that reach hold them.
class PaddedImage : public ImageReader {
 public:
  /// @param reach how far away filters of this image take values from, along each axis
  /// @param box whose corners are looked at, too
  explicit PaddedImage(ImageReader& image, int reach = 0, const CoordBBox& box = CoordBBox::inf());
  void read(int first, int count, void* samples) override;

  /// The value at the corners of all slices read so far; none if they differ, or it is no number.
  std::optional<double> corner() const;
  /// The voxels [begin, end) along x of a row that lie between its padding; `begin` may be above
  /// `end`.
  std::pair<int, int> within(int y, int z) const {
    return rows_[size_t(z % depth_) * size_t(info_.size.y) + size_t(y)];
  }
  /// The voxels [begin, end) of a row that filters mix with no padding, of this row and others.
  std::pair<int, int> apart(int y, int z) const;
  /// Whether one of the four corners of the box is padding, in any of its slices read so far.
  bool isAtCorners() const { return isAtCorners_; }

 private:
  ImageReader& image_;
  const int reach_, depth_;
  CoordBBox box_;
  std::optional<double> corner_;
  bool cornersDiffer_ = false, isAtCorners_ = false;
  std::vector<std::pair<int, int>> rows_;  // of the last `depth_` slices
};

}  // namespace vdb_madf::detail
