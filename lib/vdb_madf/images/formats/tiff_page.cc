// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/images/formats/tiff_page.h"

#include <algorithm>
#include <cstring>
#include <memory>

#include "vdb_madf/base/detail/byte_order.h"
#include "vdb_madf/base/limits.h"
#include "vdb_madf/images/detail/gray_colors.h"

namespace vdb_madf::detail {

namespace {

constexpr uint32_t kMaxPageSide = kMaxImageSide;
/// Red, green, blue, and opacity or whatever a program adds.
constexpr uint16_t kMaxChannels = 16;
/// libtiff allocates tag values, raw strips (no larger than the file) and coder states.
constexpr int64_t kCoderAllocation = int64_t(1) << 25;

/// How many bytes one compressed byte stands for at most; 0: a compression that is not read.
uint64_t maxExpansion(uint16_t compression, uint32_t width) {
  switch (compression) {
    case COMPRESSION_NONE:
      return 1;
    case COMPRESSION_PACKBITS:
      return 64;
    case COMPRESSION_LZW:
      return 4096;  // a code of 9 bits and more stands for at most a full table
    case COMPRESSION_DEFLATE:
    case COMPRESSION_ADOBE_DEFLATE:
      return 1032;
    case COMPRESSION_ZSTD:
      return 1 << 16;  // a block of four bytes is at most 128 KiB
    case COMPRESSION_CCITTRLE:
    case COMPRESSION_CCITTRLEW:
    case COMPRESSION_CCITTFAX3:
    case COMPRESSION_CCITTFAX4:
      return 8 * (uint64_t(width) / 8 + 1);  // a row takes at least a bit
    default:
      return 0;
  }
}

bool isFax(uint16_t compression) {
  return compression == COMPRESSION_CCITTRLE || compression == COMPRESSION_CCITTRLEW ||
         compression == COMPRESSION_CCITTFAX3 || compression == COMPRESSION_CCITTFAX4;
}

std::optional<SampleType> sampleType(uint16_t bits, uint16_t format) {
  const bool isUnsigned = format == SAMPLEFORMAT_UINT || format == SAMPLEFORMAT_VOID;
  const bool isSigned = format == SAMPLEFORMAT_INT, isFloat = format == SAMPLEFORMAT_IEEEFP;
  if (bits == 1 && isUnsigned) return SampleType::uint8;
  if (bits == 8 && isUnsigned) return SampleType::uint8;
  if (bits == 8 && isSigned) return SampleType::int8;
  if (bits == 16 && isUnsigned) return SampleType::uint16;
  if (bits == 16 && isSigned) return SampleType::int16;
  if (bits == 32 && isUnsigned) return SampleType::uint32;
  if (bits == 32 && isSigned) return SampleType::int32;
  if (bits == 32 && isFloat) return SampleType::float32;
  if (bits == 64 && isFloat) return SampleType::float64;
  return std::nullopt;
}

/// `count` bits, first in the highest bit, to a byte each.
void expandBits(const unsigned char* bits, size_t count, char* bytes) {
  for (size_t i = 0; i < count; ++i) bytes[i] = char(bits[i >> 3] >> (7 - (i & 7)) & 1u);
}

}  // namespace

TiffFile::TiffFile(std::unique_ptr<InputFile> file)
    : data_(std::move(file)), tiff_(*data_, int64_t(data_->size()) + kCoderAllocation) {}

TiffFile::TiffFile(const std::string& path) : TiffFile(std::make_unique<InputFile>(path)) {}

bool TiffFile::isSlice() const {
  return (tiff_.field<uint32_t>(TIFFTAG_SUBFILETYPE, 0) &
          (FILETYPE_REDUCEDIMAGE | FILETYPE_MASK)) == 0;
}

uint64_t TiffFile::number(uint64_t offset, size_t bytes) const {
  uint64_t value = 0;
  data_->read(offset, &value, bytes);
  if (TIFFIsByteSwapped(tiff_.get())) swapBytes(&value, 1, bytes);
  return value;
}

bool TiffFile::isLast() const {
  if (!TIFFLastDirectory(tiff_.get())) return false;
  // libtiff takes a link to the next page that it cannot read for none, so it is read again.
  const bool big = TIFFIsBigTIFF(tiff_.get()) != 0;
  const uint64_t countBytes = big ? 8 : 2, entryBytes = big ? 20 : 12, linkBytes = big ? 8 : 4;
  const uint64_t entries = number(directory(), countBytes);
  if (number(directory() + countBytes + entries * entryBytes, linkBytes) != 0)
    tiff_.fail("a page is damaged or missing");
  return true;
}

void TiffFile::next() {
  if (!TIFFReadDirectory(tiff_.get())) tiff_.fail("a page is damaged or missing");
}

void TiffFile::select(uint64_t directory) {
  if (!TIFFSetSubDirectory(tiff_.get(), directory)) tiff_.fail("a page is damaged");
}

TiffPage TiffFile::page() const {
  TiffPage page;
  page.width = tiff_.field<uint32_t>(TIFFTAG_IMAGEWIDTH, 0);
  page.height = tiff_.field<uint32_t>(TIFFTAG_IMAGELENGTH, 0);
  if (page.width < 1 || page.width > kMaxPageSide || page.height < 1 || page.height > kMaxPageSide)
    tiff_.fail("a page of " + std::to_string(page.width) + " x " + std::to_string(page.height) +
               " is not within 1 .. " + std::to_string(kMaxPageSide) + " a side");
  uint16_t format = SAMPLEFORMAT_UINT;
  TIFFGetFieldDefaulted(tiff_.get(), TIFFTAG_SAMPLESPERPIXEL, &page.channels);
  TIFFGetFieldDefaulted(tiff_.get(), TIFFTAG_BITSPERSAMPLE, &page.bits);
  TIFFGetFieldDefaulted(tiff_.get(), TIFFTAG_SAMPLEFORMAT, &format);
  if (page.channels != 1 && !isColor(page))
    tiff_.fail("has " + std::to_string(page.channels) +
               " samples per pixel, and not as a plain color: convert it to gray values first");
  if (tiff_.field<uint32_t>(TIFFTAG_IMAGEDEPTH, 1) != 1) tiff_.fail("has pages with a depth");
  const auto type = sampleType(page.bits, format);
  if (!type)
    tiff_.fail("has samples of " + std::to_string(page.bits) + " bits in format " +
               std::to_string(format) +
               ": only 1, 8, 16 and 32-bit integers and 32 and 64-bit floats can be read");
  page.type = *type;
  page.compression = tiff_.field<uint16_t>(TIFFTAG_COMPRESSION, COMPRESSION_NONE);
  if (maxExpansion(page.compression, page.width) == 0 || !TIFFIsCODECConfigured(page.compression) ||
      (isFax(page.compression) && page.bits != 1))
    tiff_.fail("compression " + std::to_string(page.compression) +
               " cannot be read: write it uncompressed, or as LZW or Deflate");
  page.tiled = TIFFIsTiled(tiff_.get()) != 0;
  page.whiteIsZero =
      tiff_.field<uint16_t>(TIFFTAG_PHOTOMETRIC, PHOTOMETRIC_MINISBLACK) == PHOTOMETRIC_MINISWHITE;
  uint16_t fillOrder = FILLORDER_MSB2LSB;
  TIFFGetFieldDefaulted(tiff_.get(), TIFFTAG_FILLORDER, &fillOrder);
  page.plain = page.compression == COMPRESSION_NONE && page.bits >= 8 && !page.tiled &&
               page.channels == 1 && fillOrder == FILLORDER_MSB2LSB;
  page.swapped = TIFFIsByteSwapped(tiff_.get()) != 0;
  checkExtent(page);
  return page;
}

bool TiffFile::isColor(const TiffPage& page) const {
  return page.channels >= 3 && page.channels <= kMaxChannels && page.bits >= 8 &&
         tiff_.field<uint16_t>(TIFFTAG_PHOTOMETRIC, PHOTOMETRIC_MINISBLACK) == PHOTOMETRIC_RGB &&
         tiff_.field<uint16_t>(TIFFTAG_PLANARCONFIG, PLANARCONFIG_CONTIG) == PLANARCONFIG_CONTIG;
}

void TiffFile::unpackRow(const TiffPage& page, const char* from, size_t count, char* to) const {
  if (page.channels > 1)
    grayOfColors(path(), from, page.channels, sampleSize(page.type), count, to);
  else if (page.bits == 1)
    expandBits(reinterpret_cast<const unsigned char*>(from), count, to);
  else
    std::memcpy(to, from, count * sampleSize(page.type));
}

void TiffFile::checkExtent(const TiffPage& page) const {
  const uint32_t pieces =
      page.tiled ? TIFFNumberOfTiles(tiff_.get()) : TIFFNumberOfStrips(tiff_.get());
  uint64_t stored = 0;
  for (uint32_t i = 0; i < pieces; ++i) {
    const uint64_t offset = TIFFGetStrileOffset(tiff_.get(), i);
    const uint64_t bytes = TIFFGetStrileByteCount(tiff_.get(), i);
    if (bytes == 0 || offset > data_->size() || bytes > data_->size() - offset)
      tiff_.fail("is truncated or damaged: the samples of a page lie outside the file");
    stored += bytes;
    // Pieces that share their bytes could make a large image of a small file.
    if (stored > data_->size()) tiff_.fail("is damaged: the parts of a page overlap");
  }
  const uint64_t packed = (page.rowBits() + 7) / 8 * page.height;
  uint64_t needed = packed;
  if (page.tiled) {
    needed = uint64_t(TIFFTileSize64(tiff_.get())) * pieces;
    const uint64_t tileWidth = tiff_.field<uint32_t>(TIFFTAG_TILEWIDTH, 0);
    const uint64_t tileHeight = tiff_.field<uint32_t>(TIFFTAG_TILELENGTH, 0);
    if (tileWidth < 1 || tileHeight < 1 || tileWidth > kMaxPageSide || tileHeight > kMaxPageSide ||
        tiff_.field<uint32_t>(TIFFTAG_TILEDEPTH, 1) != 1)
      tiff_.fail("has tiles of an impossible size");
  }
  if (needed == 0 || needed / maxExpansion(page.compression, page.width) > stored)
    tiff_.fail("is truncated or damaged: " + std::to_string(stored) +
               " bytes are too few for a page of " + std::to_string(page.width) + " x " +
               std::to_string(page.height));
}

std::optional<uint64_t> TiffFile::contiguousOffset(const TiffPage& page) const {
  const uint64_t offset = TIFFGetStrileOffset(tiff_.get(), 0);
  uint64_t end = offset;
  const uint32_t strips = TIFFNumberOfStrips(tiff_.get());
  for (uint32_t i = 0; i < strips; ++i) {
    if (TIFFGetStrileOffset(tiff_.get(), i) != end) return std::nullopt;
    end += TIFFGetStrileByteCount(tiff_.get(), i);
  }
  if (!page.plain || end != offset + page.bytes()) return std::nullopt;
  return offset;
}

void TiffFile::decode(const TiffPage& page, void* samples) const {
  char* to = static_cast<char*>(samples);
  if (page.plain)
    readPlain(page, to);
  else if (page.tiled)
    decodeTiles(page, to);
  else
    decodeStrips(page, to);
}

void TiffFile::readPlain(const TiffPage& page, char* samples) const {
  // Strips that follow each other, as nearly always, are one read.
  const uint32_t strips = TIFFNumberOfStrips(tiff_.get());
  const uint64_t rows =
      std::min(tiff_.field<uint32_t>(TIFFTAG_ROWSPERSTRIP, page.height), page.height);
  const uint64_t stripBytes = rows * page.width * sampleSize(page.type);
  uint64_t done = 0, begin = 0, pending = 0;
  for (uint32_t i = 0; i < strips && done + pending < page.bytes(); ++i) {
    const uint64_t offset = TIFFGetStrileOffset(tiff_.get(), i);
    const uint64_t bytes = std::min(stripBytes, page.bytes() - done - pending);
    if (TIFFGetStrileByteCount(tiff_.get(), i) < bytes)
      tiff_.fail("is truncated or damaged: a strip is too short");
    if (offset != begin + pending) {
      data_->read(begin, samples + done, size_t(pending));
      done += pending;
      begin = offset;
      pending = 0;
    }
    pending += bytes;
  }
  data_->read(begin, samples + done, size_t(pending));
  if (done + pending != page.bytes()) tiff_.fail("is damaged: strips are missing");
  if (page.swapped) swapBytes(samples, size_t(page.width) * page.height, sampleSize(page.type));
}

void TiffFile::decodeStrips(const TiffPage& page, char* samples) const {
  const uint32_t rows =
      std::min(tiff_.field<uint32_t>(TIFFTAG_ROWSPERSTRIP, page.height), page.height);
  if (rows == 0) tiff_.fail("has strips without rows");
  const size_t rowBytes = size_t(page.rowBits() + 7) / 8;
  const size_t rowSamples = size_t(page.width) * sampleSize(page.type);
  std::unique_ptr<char[]> packed;
  if (page.bits == 1 || page.channels > 1) packed.reset(new char[rowBytes * rows]);
  for (uint32_t strip = 0, y = 0; y < page.height; ++strip, y += rows) {
    const uint32_t count = std::min(rows, page.height - y);
    char* to = packed ? packed.get() : samples + rowSamples * y;
    const tmsize_t bytes = tmsize_t(rowBytes * count);
    if (TIFFReadEncodedStrip(tiff_.get(), strip, to, bytes) != bytes)
      tiff_.fail("is damaged: a page cannot be decoded");
    // The fax decoders fill up damaged rows and only warn.
    if (isFax(page.compression) && tiff_.warned()) tiff_.fail("is damaged: fax rows are broken");
    for (uint32_t row = 0; packed && row < count; ++row)
      unpackRow(page, packed.get() + rowBytes * row, page.width, samples + rowSamples * (y + row));
  }
}

void TiffFile::decodeTiles(const TiffPage& page, char* samples) const {
  const uint32_t tileWidth = tiff_.field<uint32_t>(TIFFTAG_TILEWIDTH, 1);
  const uint32_t tileHeight = tiff_.field<uint32_t>(TIFFTAG_TILELENGTH, 1);
  const size_t rowBytes = (size_t(tileWidth) * page.bits * page.channels + 7) / 8;
  const size_t sample = sampleSize(page.type);
  const tmsize_t tileBytes = tmsize_t(rowBytes * tileHeight);
  const std::unique_ptr<char[]> tile(new char[size_t(tileBytes)]);
  for (uint32_t y = 0; y < page.height; y += tileHeight)
    for (uint32_t x = 0; x < page.width; x += tileWidth) {
      const uint32_t number = TIFFComputeTile(tiff_.get(), x, y, 0, 0);
      if (TIFFReadEncodedTile(tiff_.get(), number, tile.get(), tileBytes) != tileBytes)
        tiff_.fail("is damaged: a tile cannot be decoded");
      if (isFax(page.compression) && tiff_.warned()) tiff_.fail("is damaged: fax rows are broken");
      const size_t columns = std::min(tileWidth, page.width - x);
      for (uint32_t row = 0; row < std::min(tileHeight, page.height - y); ++row) {
        const char* from = tile.get() + rowBytes * row;
        unpackRow(page, from, columns, samples + (size_t(y + row) * page.width + x) * sample);
      }
    }
}

}  // namespace vdb_madf::detail
