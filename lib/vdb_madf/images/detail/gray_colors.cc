// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/images/detail/gray_colors.h"

#include <cstring>

#include "vdb_madf/base/errors.h"

namespace vdb_madf::detail {

void grayOfColors(const std::string& name, const void* pixels, size_t channels, size_t bytes,
                  size_t count, void* samples) {
  const char* pixel = static_cast<const char*>(pixels);
  char* sample = static_cast<char*>(samples);
  for (size_t i = 0; i < count; ++i, pixel += channels * bytes, sample += bytes) {
    if (std::memcmp(pixel, pixel + bytes, 2 * bytes) != 0)
      throw IoError(name +
                    ": is a picture in colors, whose red, green and blue differ: convert it to "
                    "gray values first");
    std::memcpy(sample, pixel, bytes);
  }
}

}  // namespace vdb_madf::detail
