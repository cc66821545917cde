// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <string>

#include "vdb_madf/files/detail/input_file.h"
#include "vdb_madf/images/image.h"

namespace vdb_madf::detail {

/// What the header of a PNG or BMP file says. Checked: the file can hold what it claims.
struct PictureHeader {
  int64_t width = 0, height = 0;  ///< each 1 .. kMaxImageSide
  SampleType type = SampleType::uint8;

  uint64_t samples() const { return uint64_t(width) * uint64_t(height); }
  bool sameAs(const PictureHeader& other) const {
    return width == other.width && height == other.height && type == other.type;
  }
  std::string text() const {
    return std::to_string(width) + " x " + std::to_string(height) + " " + sampleTypeName(type);
  }
};

// Samples are returned as stored, the top row first: gray values, or the numbers of a palette,
// which is what a program that writes labels means. A color (n, n, n) is the gray value n; any
// other color is an error. Opacity is ignored.

/// PNG of 1, 2, 4, 8 (uint8) or 16 bits (uint16), interlaced or not.
/// Source: Portable Network Graphics specification; decoded by libpng.
PictureHeader pngHeader(const InputFile& file);
void readPng(const InputFile& file, const PictureHeader& picture, void* samples);

/// BMP of 1, 4, 8, 24 or 32 bits, uncompressed, either row order. Of two colors the brighter is 1.
/// Source: BITMAPFILEHEADER, BITMAPCOREHEADER and BITMAPINFOHEADER of the Windows documentation.
PictureHeader bmpHeader(const InputFile& file);
void readBmp(const InputFile& file, const PictureHeader& picture, void* samples);

/// True for the first bytes of such a file.
bool isPngHeader(const std::string& head);
bool isBmpHeader(const std::string& head);

/// @throw IoError unless each side is in 1 .. kMaxImageSide.
void checkPictureSize(const std::string& name, int64_t width, int64_t height);
}  // namespace vdb_madf::detail
