// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "vdb_madf/files/detail/input_file.h"
#include "vdb_madf/images/formats/tiff_handle.h"
#include "vdb_madf/images/image.h"

namespace vdb_madf::detail {

/// The checked layout of one TIFF page.
struct TiffPage {
  uint32_t width = 0, height = 0;
  uint16_t bits = 0;
  uint16_t channels = 1;  ///< stored for a pixel; of a color the first three have to be equal
  SampleType type = SampleType::uint8;
  uint16_t compression = COMPRESSION_NONE;
  bool tiled = false;
  bool whiteIsZero = false;  ///< viewers show it inverted
  bool plain = false;        ///< the bytes in the file are the samples, but for their order
  bool swapped = false;      ///< plain samples are in foreign byte order

  /// The bits of a row as it is stored.
  uint64_t rowBits() const { return uint64_t(width) * bits * channels; }
  uint64_t bytes() const { return uint64_t(width) * height * sampleSize(type); }
  bool sameAs(const TiffPage& other) const {
    return width == other.width && height == other.height && type == other.type;
  }
};

/// A TIFF file, page by page. Nothing is decoded before decode() is called.
class TiffFile {
 public:
  explicit TiffFile(std::unique_ptr<InputFile> file);
  explicit TiffFile(const std::string& path);

  const std::string& path() const { return data_->name(); }
  /// The current page. Its strips and tiles lie within the file and can hold what it claims.
  /// @throw IoError if it is not a gray image of a known type.
  TiffPage page() const;
  /// Thumbnails and transparency masks are not slices.
  bool isSlice() const;
  uint64_t directory() const { return TIFFCurrentDirOffset(tiff_.get()); }
  /// @throw IoError if the file ends, or cannot be read, where it would say which page is next.
  bool isLast() const;
  void next();
  void select(uint64_t directory);
  /// The samples of the current page, native byte order.
  void decode(const TiffPage& page, void* samples) const;

  /// Plain pages only: where the samples begin if they lie in one piece.
  std::optional<uint64_t> contiguousOffset(const TiffPage& page) const;
  const InputFile& data() const { return *data_; }
  const TiffHandle& handle() const { return tiff_; }

 private:
  uint64_t number(uint64_t offset, size_t bytes) const;
  bool isColor(const TiffPage& page) const;
  void checkExtent(const TiffPage& page) const;
  void unpackRow(const TiffPage& page, const char* from, size_t count, char* to) const;
  void readPlain(const TiffPage& page, char* samples) const;
  void decodeStrips(const TiffPage& page, char* samples) const;
  void decodeTiles(const TiffPage& page, char* samples) const;

  std::unique_ptr<InputFile> data_;
  TiffHandle tiff_;
};

}  // namespace vdb_madf::detail
