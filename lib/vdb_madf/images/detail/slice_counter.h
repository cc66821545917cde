// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <string>

#include "vdb_madf/base/errors.h"
#include "vdb_madf/base/limits.h"
#include "vdb_madf/images/detail/header_checks.h"
#include "vdb_madf/images/image.h"

namespace vdb_madf::detail {

/// Keeps a writer honest: as many slices as the image has, no more and no fewer.
class SliceCounter {
 public:
  /// @throw InvalidInput for sizes that no image has.
  SliceCounter(const std::string& path, const ImageInfo& info) : path_(path), info_(info) {
    for (int axis = 0; axis < 3; ++axis)
      if (info.size[axis] < 1 || info.size[axis] > kMaxImageSide)
        throw InvalidInput(path + ": an image is 1 .. " + std::to_string(kMaxImageSide) +
                           " voxels a side");
  }

  const ImageInfo& info() const { return info_; }
  int written() const { return written_; }

  /// The bytes of `count` further slices. @throw InvalidInput if that is too many.
  size_t add(int count) {
    checkSlices(path_, info_, written_, count);
    written_ += count;
    return size_t(sliceBytes(info_)) * size_t(count);
  }
  /// @throw InvalidInput if slices are missing.
  void finish() const {
    if (written_ != info_.size.z)
      throw InvalidInput(path_ + ": only " + std::to_string(written_) + " of " +
                         std::to_string(info_.size.z) + " slices were written");
  }

 private:
  std::string path_;
  ImageInfo info_;
  int written_ = 0;
};

}  // namespace vdb_madf::detail
