// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/pictures/png_file.h"

#include <png.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <vector>

#include "vdb_madf/base/errors.h"
#include "vdb_madf/files/detail/output_stream.h"

namespace vdb_madf {

namespace {

constexpr size_t kHeaderBytes = 33;  // signature and IHDR
/// The chunk pHYs of 11811 pixels a meter, with its length and check sum.
constexpr std::array<unsigned char, 21> kDotsPerInch300{0x00, 0x00, 0x00, 0x09, 'p',  'H',  'Y',
                                                        's',  0x00, 0x00, 0x2e, 0x23, 0x00, 0x00,
                                                        0x2e, 0x23, 0x01, 0x78, 0xa5, 0x3f, 0x76};

std::string encoded(const Picture& size, png_uint_32 format, const void* pixels) {
  png_image image;
  std::memset(&image, 0, sizeof(image));
  image.version = PNG_IMAGE_VERSION;
  image.width = png_uint_32(size.width);
  image.height = png_uint_32(size.height);
  image.format = format;
  png_alloc_size_t bytesAtMost = PNG_IMAGE_PNG_SIZE_MAX(image);
  std::string bytes(bytesAtMost, 0);
  if (!png_image_write_to_memory(&image, bytes.data(), &bytesAtMost, 0, pixels, 0, nullptr))
    throw IoError(std::string("the picture cannot be made: ") + image.message);
  bytes.resize(bytesAtMost);
  bytes.insert(kHeaderBytes, reinterpret_cast<const char*>(kDotsPerInch300.data()),
               kDotsPerInch300.size());
  return bytes;
}

template <typename... Pictures>
void writeBytes(const std::string& path, const Pictures&... pictures) {
  detail::OutputStream file(path);
  std::string bytes;
  try {
    bytes = pngBytes(pictures...);
  } catch (const IoError& error) {
    throw IoError(path + ": " + error.what());
  }
  file.text(bytes);
  file.close();
  file.commit();
}

}  // namespace

std::string pngBytes(const Picture& picture) {
  return encoded(picture, PNG_FORMAT_RGB, picture.pixels.data());
}

std::string pngBytes(const Picture& onWhite, const Picture& onBlack) {
  std::vector<uint8_t> pixels;
  pixels.reserve(4 * onBlack.pixels.size());
  for (size_t i = 0; i < onBlack.pixels.size(); ++i) {
    int shines = 0;  // of the background
    for (size_t k = 0; k < 3; ++k)
      shines = std::max(shines, int(onWhite.pixels[i][k]) - int(onBlack.pixels[i][k]));
    const int cover = 255 - shines;
    for (const uint8_t channel : onBlack.pixels[i])
      pixels.push_back(cover == 0 ? 0
                                  : uint8_t(std::min(255, (255 * channel + cover / 2) / cover)));
    pixels.push_back(uint8_t(cover));
  }
  return encoded(onBlack, PNG_FORMAT_RGBA, pixels.data());
}

void writePng(const std::string& path, const Picture& picture) {
  writeBytes(path, picture);
}

void writePng(const std::string& path, const Picture& onWhite, const Picture& onBlack) {
  writeBytes(path, onWhite, onBlack);
}

}  // namespace vdb_madf
