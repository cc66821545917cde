// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "png_file.h"

#include <png.h>

#include <cerrno>
#include <cstring>

#include "vdb_madf/base/errors.h"
#include "vdb_madf/files/output_file.h"

namespace vdb_madf::tools {

void writePng(const std::string& path, const Picture& picture) {
  OutputFile file(path);
  png_image image;
  std::memset(&image, 0, sizeof(image));
  image.version = PNG_IMAGE_VERSION;
  image.width = png_uint_32(picture.width);
  image.height = png_uint_32(picture.height);
  image.format = PNG_FORMAT_RGB;
  if (!png_image_write_to_file(&image, file.temporaryPath().c_str(), 0, picture.pixels.data(), 0,
                               nullptr))
    throw IoError(path + ": cannot be written: " + image.message);
  file.commit();
}

}  // namespace vdb_madf::tools
