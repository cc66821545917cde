// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/images/formats/picture_slice.h"

#include "vdb_madf/base/errors.h"
#include "vdb_madf/base/limits.h"

namespace vdb_madf::detail {

void checkPictureSize(const std::string& name, int64_t width, int64_t height) {
  if (width < 1 || height < 1 || width > kMaxImageSide || height > kMaxImageSide)
    throw IoError(name + ": size " + std::to_string(width) + " x " + std::to_string(height) +
                  " is not within 1 .. " + std::to_string(kMaxImageSide) + " a side");
}

}  // namespace vdb_madf::detail
