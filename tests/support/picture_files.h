// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <zlib.h>

#include <string>

#include "support/header_files.h"
#include "support/images.h"

// PNG and BMP files, built by hand from their definitions.

namespace vdb_madf::test {

struct PngLayout {
  int width = 0, height = 0;
  int bits = 8;
  int colour = 0;  ///< 0 gray, 2 RGB, 3 palette, 4 gray and opacity, 6 RGB and opacity
  bool interlaced = false;
};

inline std::string pngChunk(const std::string& kind, const std::string& content) {
  std::string bytes(4, '\0');
  put(bytes, 0, uint32_t(content.size()), true);
  const std::string body = kind + content;
  std::string check(4, '\0');
  put(check, 0, uint32_t(crc32(0, reinterpret_cast<const Bytef*>(body.data()), uInt(body.size()))),
      true);
  return bytes + body + check;
}

/// `samples`: a byte (16 bits: two, most significant first) per channel, row by row.
inline std::string pngFile(const PngLayout& layout, const std::string& samples) {
  const int channels[] = {1, 0, 3, 1, 2, 0, 4};
  const size_t sample = layout.bits == 16 ? 2 : 1, pixel = sample * size_t(channels[layout.colour]);
  std::string rows;
  // Where the pixels of each pass of Adam7 begin, and how far apart they are.
  const int passes[7][4] = {{0, 0, 8, 8}, {4, 0, 8, 8}, {0, 4, 4, 8}, {2, 0, 4, 4},
                            {0, 2, 2, 4}, {1, 0, 2, 2}, {0, 1, 1, 2}};
  const int whole[1][4] = {{0, 0, 1, 1}};
  const auto* pass = layout.interlaced ? passes : whole;
  for (int p = 0; p < (layout.interlaced ? 7 : 1); ++p)
    for (int y = pass[p][1]; y < layout.height; y += pass[p][3]) {
      std::string row;
      int filled = 0;  // bits of the last byte
      for (int x = pass[p][0]; x < layout.width; x += pass[p][2]) {
        const std::string one =
            samples.substr((size_t(y) * size_t(layout.width) + size_t(x)) * pixel, pixel);
        if (layout.bits >= 8) {
          row += one;
          continue;
        }
        if (filled % 8 == 0) row += '\0';
        row.back() = char(row.back() | one[0] << (8 - layout.bits - filled % 8));
        filled += layout.bits;
      }
      if (!row.empty()) rows += '\0' + row;  // no filter
    }
  std::string header(13, '\0');
  put(header, 0, uint32_t(layout.width), true);
  put(header, 4, uint32_t(layout.height), true);
  header[8] = char(layout.bits);
  header[9] = char(layout.colour);
  header[12] = char(layout.interlaced);
  std::string bytes = "\x89PNG\r\n\x1a\n" + pngChunk("IHDR", header);
  if (layout.colour == 3) bytes += pngChunk("PLTE", std::string(3 << layout.bits, '\x55'));
  return bytes + pngChunk("IDAT", deflated(rows, 15)) + pngChunk("IEND", "");
}

struct BmpLayout {
  int width = 0, height = 0;
  int bits = 8;
  bool topDown = false, core = false;
  std::string palette;
  uint32_t compression = 0;
  uint32_t gap = 0;  ///< between palette and pixels
};

/// `rows`: packed as in the file but not padded, the top row first.
inline std::string bmpFile(const BmpLayout& layout, const std::string& rows) {
  std::string bytes(14 + (layout.core ? 12 : 40), '\0');
  bytes.replace(0, 2, "BM");
  put(bytes, 10, uint32_t(bytes.size() + layout.palette.size() + layout.gap));
  put(bytes, 14, uint32_t(layout.core ? 12 : 40));
  if (layout.core) {
    put(bytes, 18, uint16_t(layout.width));
    put(bytes, 20, uint16_t(layout.height));
    put(bytes, 24, uint16_t(layout.bits));
  } else {
    put(bytes, 18, int32_t(layout.width));
    put(bytes, 22, int32_t(layout.topDown ? -layout.height : layout.height));
    put(bytes, 28, uint16_t(layout.bits));
    put(bytes, 30, layout.compression);
  }
  bytes += layout.palette + std::string(layout.gap, '\7');
  const size_t row = rows.size() / size_t(layout.height);
  for (int i = 0; i < layout.height; ++i) {
    const int y = layout.topDown ? i : layout.height - 1 - i;
    bytes += rows.substr(size_t(y) * row, row) + std::string((4 - row % 4) % 4, '\xee');
  }
  return bytes;
}

}  // namespace vdb_madf::test
