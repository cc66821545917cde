// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include <cstring>
#include <vector>

#include "vdb_madf/base/errors.h"
#include "vdb_madf/images/detail/gray_colors.h"
#include "vdb_madf/images/formats/picture_slice.h"

namespace vdb_madf::detail {

namespace {

constexpr size_t kFileHeader = 14;
/// The old header has 16-bit sizes and colors of three bytes.
constexpr size_t kCoreHeader = 12, kInfoHeader = 40;
constexpr size_t kBmpHeaderBytes = kFileHeader + kInfoHeader;

struct BmpLayout {
  int64_t width = 0, height = 0;
  bool topDown = false;
  int bits = 0;
  uint64_t offset = 0, paletteOffset = 0, colorBytes = 4;

  uint64_t rowBytes() const { return (uint64_t(width) * uint64_t(bits) + 31) / 32 * 4; }
};

template <typename T>
T numberAt(const std::string& bytes, size_t offset) {
  T value;
  std::memcpy(&value, &bytes[offset], sizeof value);
  return value;
}

BmpLayout layoutOf(const InputFile& file) {
  std::string head = file.head(kBmpHeaderBytes);
  if (!isBmpHeader(head) || head.size() < kFileHeader + kCoreHeader)
    throw IoError(file.name() + ": is not a whole BMP file");
  head.resize(kBmpHeaderBytes);  // the shorter header ends earlier
  const auto headerSize = numberAt<uint32_t>(head, 14);
  BmpLayout layout;
  layout.offset = numberAt<uint32_t>(head, 10);
  layout.paletteOffset = kFileHeader + uint64_t(headerSize);
  if (headerSize == kCoreHeader) {
    layout.width = numberAt<uint16_t>(head, 18);
    layout.height = numberAt<uint16_t>(head, 20);
    layout.bits = numberAt<uint16_t>(head, 24);
    layout.colorBytes = 3;
  } else if (headerSize >= kInfoHeader && headerSize <= 1024) {
    layout.width = numberAt<int32_t>(head, 18);
    layout.height = numberAt<int32_t>(head, 22);
    layout.bits = numberAt<uint16_t>(head, 28);
    if (numberAt<uint32_t>(head, 30) != 0)
      throw IoError(file.name() + ": is a compressed BMP; save it uncompressed or as PNG");
  } else {
    throw IoError(file.name() + ": its BMP header of " + std::to_string(headerSize) +
                  " bytes cannot be read");
  }
  layout.topDown = layout.height < 0;
  if (layout.topDown) layout.height = -layout.height;
  checkPictureSize(file.name(), layout.width, layout.height);
  if (layout.bits != 1 && layout.bits != 4 && layout.bits != 8 && layout.bits != 24 &&
      layout.bits != 32)
    throw IoError(file.name() + ": BMP of " + std::to_string(layout.bits) +
                  " bits cannot be read; only 1, 4, 8, 24 and 32");
  const uint64_t needed = layout.rowBytes() * uint64_t(layout.height);
  if (layout.offset < layout.paletteOffset || layout.offset > file.size() ||
      needed > file.size() - layout.offset)
    throw IoError(file.name() + ": is cut short: " + std::to_string(file.size()) +
                  " bytes, but its pixels take " + std::to_string(needed) + " from " +
                  std::to_string(layout.offset) + " on");
  return layout;
}

/// White and black may be numbered either way.
bool firstIsBrighter(const InputFile& file, const BmpLayout& layout) {
  unsigned char colors[8] = {};
  file.read(layout.paletteOffset, colors, 2 * layout.colorBytes);
  const auto brightness = [&](size_t i) {
    const unsigned char* color = colors + i * layout.colorBytes;
    return int(color[0]) + color[1] + color[2];
  };
  return brightness(0) > brightness(1);
}

/// Packed pixels, the first in the highest bits.
void unpack(const unsigned char* row, int bits, size_t count, unsigned flip,
            unsigned char* samples) {
  const size_t perByte = size_t(8 / bits);
  const unsigned mask = (1u << bits) - 1;
  for (size_t x = 0; x < count; ++x) {
    const unsigned shift = unsigned(perByte - 1 - x % perByte) * unsigned(bits);
    samples[x] = static_cast<unsigned char>((row[x / perByte] >> shift & mask) ^ flip);
  }
}

}  // namespace

bool isBmpHeader(const std::string& head) {
  // The file begins with two letters only: look at the size of the second header, too.
  if (head.compare(0, 2, "BM") != 0 || head.size() < 18) return false;
  const auto headerSize = numberAt<uint32_t>(head, 14);
  return headerSize == kCoreHeader || (headerSize >= kInfoHeader && headerSize <= 1024);
}

PictureHeader bmpHeader(const InputFile& file) {
  const BmpLayout layout = layoutOf(file);
  return {layout.width, layout.height, SampleType::uint8};
}

void readBmp(const InputFile& file, const PictureHeader& picture, void* samples) {
  const BmpLayout layout = layoutOf(file);
  if (layout.width != picture.width || layout.height != picture.height)
    throw IoError(file.name() + ": changed while it was read");
  const unsigned flip = layout.bits == 1 && firstIsBrighter(file, layout) ? 1 : 0;
  const size_t width = size_t(layout.width);
  std::vector<unsigned char> row(size_t(layout.rowBytes()));
  for (int64_t y = 0; y < layout.height; ++y) {
    file.read(layout.offset + layout.rowBytes() * uint64_t(y), row.data(), row.size());
    const int64_t line = layout.topDown ? y : layout.height - 1 - y;
    unsigned char* to = static_cast<unsigned char*>(samples) + size_t(line) * width;
    if (layout.bits < 8)
      unpack(row.data(), layout.bits, width, flip, to);
    else if (layout.bits == 8)
      std::memcpy(to, row.data(), width);
    else
      grayOfColors(file.name(), row.data(), size_t(layout.bits) / 8, 1, width, to);
  }
}

}  // namespace vdb_madf::detail
