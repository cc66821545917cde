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

void grayOfColors(const std::string& name, const unsigned char* pixels, size_t bytesPerPixel,
                  size_t count, unsigned char* samples) {
  for (size_t i = 0; i < count; ++i, pixels += bytesPerPixel) {
    if (pixels[0] != pixels[1] || pixels[0] != pixels[2])
      throw IoError(name + ": is a picture in colours: convert it to grey values first");
    samples[i] = pixels[0];
  }
}

}  // namespace vdb_madf::detail
