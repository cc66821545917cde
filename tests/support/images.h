// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <tiffio.h>
#include <zlib.h>

#include <algorithm>
#include <cstdarg>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <memory>
#include <optional>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include "vdb_madf/images/image.h"

namespace vdb_madf::test {

constexpr SampleType kSampleTypes[] = {SampleType::uint8,   SampleType::int8,   SampleType::uint16,
                                       SampleType::int16,   SampleType::uint32, SampleType::int32,
                                       SampleType::float32, SampleType::float64};

inline size_t voxels(const ImageSize& size) {
  return size_t(size.x) * size_t(size.y) * size_t(size.z);
}

/// The bytes of `count` samples: half of them 0, 1 or 2, the others any number of the type.
inline std::string randomSamples(SampleType type, size_t count, unsigned seed) {
  std::mt19937 random(seed);
  std::string bytes;
  const auto add = [&](auto value) {
    bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
  };
  for (size_t i = 0; i < count; ++i) {
    const uint32_t value = random() % 2 ? random() % 3 : uint32_t(random());
    switch (type) {
      case SampleType::uint8:
      case SampleType::int8:
        add(uint8_t(value));
        break;
      case SampleType::uint16:
      case SampleType::int16:
        add(uint16_t(value));
        break;
      case SampleType::uint32:
      case SampleType::int32:
        add(value);
        break;
      case SampleType::float32:
        add(float(int32_t(value)) / 2);
        break;
      case SampleType::float64:
        add(double(int32_t(value)) / 2);
        break;
    }
  }
  return bytes;
}

inline std::string swapped(std::string bytes, size_t size) {
  for (size_t i = 0; i + size <= bytes.size(); i += size)
    std::reverse(bytes.begin() + std::ptrdiff_t(i), bytes.begin() + std::ptrdiff_t(i + size));
  return bytes;
}

/// zlib (window bits 15) or gzip (31).
inline std::string deflated(const std::string& bytes, int windowBits) {
  z_stream stream{};
  deflateInit2(&stream, 6, Z_DEFLATED, windowBits, 8, Z_DEFAULT_STRATEGY);
  std::string out(deflateBound(&stream, bytes.size()), '\0');
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
  stream.avail_in = uInt(bytes.size());
  stream.next_out = reinterpret_cast<Bytef*>(out.data());
  stream.avail_out = uInt(out.size());
  deflate(&stream, Z_FINISH);
  out.resize(stream.total_out);
  deflateEnd(&stream);
  return out;
}

/// All samples of an image, read in slabs of `step` slices.
inline std::string readAll(ImageReader& image, int step = 1 << 20) {
  const ImageSize size = image.info().size;
  const size_t slice = size_t(size.x) * size_t(size.y) * sampleSize(image.info().type);
  std::string bytes(slice * size_t(size.z), '\x5a');
  for (int z = 0; z < size.z; z += std::min(step, size.z - z))
    image.read(z, std::min(step, size.z - z), bytes.data() + slice * size_t(z));
  return bytes;
}

/// How a TIFF file is laid out, for tests that write one with libtiff.
struct TiffLayout {
  std::string mode = "w";  ///< libtiff's: "wb" big-endian, "wl", "w8" BigTIFF
  int compression = COMPRESSION_NONE;
  uint32_t rowsPerStrip = 3;
  uint32_t tile = 0;  ///< edge; 0: strips
  int bits = 0;       ///< 0: those of the type
  int format = 0;     ///< 0: that of the type
  int photometric = PHOTOMETRIC_MINISBLACK;
  int channels = 1;
  int predictor = 0;
  std::string description;
  double resolution = 0;
  int resolutionUnit = 0;  ///< 0: not said
};

inline int formatOf(SampleType type) {
  if (type == SampleType::float32 || type == SampleType::float64) return SAMPLEFORMAT_IEEEFP;
  const bool negative =
      type == SampleType::int8 || type == SampleType::int16 || type == SampleType::int32;
  return negative ? SAMPLEFORMAT_INT : SAMPLEFORMAT_UINT;
}

inline void setTiffTags(TIFF* tiff, const ImageSize& size, SampleType type,
                        const TiffLayout& layout) {
  TIFFSetField(tiff, TIFFTAG_IMAGEWIDTH, uint32_t(size.x));
  TIFFSetField(tiff, TIFFTAG_IMAGELENGTH, uint32_t(size.y));
  TIFFSetField(tiff, TIFFTAG_SAMPLESPERPIXEL, layout.channels);
  TIFFSetField(tiff, TIFFTAG_BITSPERSAMPLE, layout.bits ? layout.bits : int(8 * sampleSize(type)));
  TIFFSetField(tiff, TIFFTAG_SAMPLEFORMAT, layout.format ? layout.format : formatOf(type));
  TIFFSetField(tiff, TIFFTAG_PHOTOMETRIC, layout.photometric);
  TIFFSetField(tiff, TIFFTAG_PLANARCONFIG, PLANARCONFIG_CONTIG);
  TIFFSetField(tiff, TIFFTAG_COMPRESSION, layout.compression);
  if (layout.predictor) TIFFSetField(tiff, TIFFTAG_PREDICTOR, layout.predictor);
  if (!layout.description.empty())
    TIFFSetField(tiff, TIFFTAG_IMAGEDESCRIPTION, layout.description.c_str());
  if (layout.resolution > 0) {
    TIFFSetField(tiff, TIFFTAG_XRESOLUTION, layout.resolution);
    TIFFSetField(tiff, TIFFTAG_YRESOLUTION, layout.resolution);
    if (layout.resolutionUnit) TIFFSetField(tiff, TIFFTAG_RESOLUTIONUNIT, layout.resolutionUnit);
  }
}

/// `bytes`: samples of the layout's bits, rows padded to whole bytes, native byte order.
inline void writeTiff(const std::string& path, const ImageSize& size, SampleType type,
                      const std::string& bytes, const TiffLayout& layout = {}) {
  TIFFOpenOptions* quiet = TIFFOpenOptionsAlloc();
  const auto ignore = [](TIFF*, void*, const char*, const char*, va_list) { return 1; };
  TIFFOpenOptionsSetWarningHandlerExtR(quiet, ignore, nullptr);
  TIFF* tiff = TIFFOpenExt(path.c_str(), layout.mode.c_str(), quiet);
  TIFFOpenOptionsFree(quiet);
  if (!tiff) throw std::runtime_error("cannot write " + path);
  const size_t bits = layout.bits ? size_t(layout.bits) : 8 * sampleSize(type);
  const size_t row = (size_t(size.x) * bits * size_t(layout.channels) + 7) / 8;
  std::string copy = bytes;  // libtiff swaps in place
  for (int z = 0; z < size.z; ++z) {
    setTiffTags(tiff, size, type, layout);
    char* slice = copy.data() + row * size_t(size.y) * size_t(z);
    if (layout.tile) {
      const size_t wide = layout.tile, sample = sampleSize(type) * size_t(layout.channels);
      TIFFSetField(tiff, TIFFTAG_TILEWIDTH, layout.tile);
      TIFFSetField(tiff, TIFFTAG_TILELENGTH, layout.tile);
      uint32_t number = 0;
      for (size_t y = 0; y < size_t(size.y); y += wide)
        for (size_t x = 0; x < size_t(size.x); x += wide) {
          std::string tile(wide * wide * sample, '\0');
          for (size_t j = 0; j < std::min(wide, size_t(size.y) - y); ++j)
            std::memcpy(&tile[j * wide * sample], slice + (y + j) * row + x * sample,
                        std::min(wide, size_t(size.x) - x) * sample);
          TIFFWriteEncodedTile(tiff, number++, tile.data(), tmsize_t(tile.size()));
        }
    } else {
      TIFFSetField(tiff, TIFFTAG_ROWSPERSTRIP, layout.rowsPerStrip);
      uint32_t strip = 0;
      for (uint32_t y = 0; y < uint32_t(size.y); y += layout.rowsPerStrip)
        TIFFWriteEncodedStrip(tiff, strip++, slice + row * y,
                              tmsize_t(row * std::min(layout.rowsPerStrip, uint32_t(size.y) - y)));
    }
    TIFFWriteDirectory(tiff);
  }
  TIFFClose(tiff);
}

/// A file of real data: its folder is named by the environment or by the build.
inline std::optional<std::string> dataFile(const std::string& name) {
  const char* folder = std::getenv("VDB_MADF_DATA");
#ifdef VDB_MADF_DATA_DIR
  if (!folder) folder = VDB_MADF_DATA_DIR;
#endif
  if (!folder) return std::nullopt;
  const std::string path = std::string(folder) + "/" + name;
  return std::ifstream(path).good() ? std::optional<std::string>(path) : std::nullopt;
}

}  // namespace vdb_madf::test
