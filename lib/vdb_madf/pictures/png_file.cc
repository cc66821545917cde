// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/pictures/png_file.h"

#include <png.h>

#include <array>
#include <cstring>

#include "vdb_madf/base/errors.h"
#include "vdb_madf/files/detail/output_stream.h"

namespace vdb_madf {

namespace {

constexpr size_t kHeaderBytes = 33;  // signature and IHDR
/// The chunk pHYs of 11811 pixels a meter, with its length and check sum.
constexpr std::array<unsigned char, 21> kDotsPerInch300{0x00, 0x00, 0x00, 0x09, 'p',  'H',  'Y',
                                                        's',  0x00, 0x00, 0x2e, 0x23, 0x00, 0x00,
                                                        0x2e, 0x23, 0x01, 0x78, 0xa5, 0x3f, 0x76};

}  // namespace

std::string pngBytes(const Picture& picture) {
  png_image image;
  std::memset(&image, 0, sizeof(image));
  image.version = PNG_IMAGE_VERSION;
  image.width = png_uint_32(picture.width);
  image.height = png_uint_32(picture.height);
  image.format = PNG_FORMAT_RGB;
  png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(image);
  std::string bytes(size, 0);
  if (!png_image_write_to_memory(&image, bytes.data(), &size, 0, picture.pixels.data(), 0, nullptr))
    throw IoError(std::string("the picture cannot be made: ") + image.message);
  bytes.resize(size);
  bytes.insert(kHeaderBytes, reinterpret_cast<const char*>(kDotsPerInch300.data()),
               kDotsPerInch300.size());
  return bytes;
}

void writePng(const std::string& path, const Picture& picture) {
  detail::OutputStream file(path);
  std::string bytes;
  try {
    bytes = pngBytes(picture);
  } catch (const IoError& error) {
    throw IoError(path + ": " + error.what());
  }
  file.text(bytes);
  file.close();
  file.commit();
}

}  // namespace vdb_madf
