// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include <algorithm>

#include "vdb_madf/base/length_unit.h"
#include "vdb_madf/files/detail/output_stream.h"
#include "vdb_madf/images/detail/header_checks.h"
#include "vdb_madf/images/detail/slice_counter.h"
#include "vdb_madf/images/formats/tiff.h"
#include "vdb_madf/images/formats/tiff_handle.h"
#include "vdb_madf/images/image.h"

namespace vdb_madf::detail {

namespace {

/// Labels and masks shrink tenfold at the fastest level already.
constexpr int kDeflateLevel = 1;
/// Readers decode a strip at a time.
constexpr uint64_t kStripBytes = uint64_t(1) << 20;
/// Offsets of classic TIFF have 32 bits.
constexpr uint64_t kMaxClassicBytes = uint64_t(4000) << 20;
/// Tags of a page and its strip table, generously.
constexpr uint64_t kPageOverhead = 4096;

/// Deflate may add a little to what it cannot compress.
bool needsBigTiff(const ImageInfo& info) {
  const uint64_t bytes = imageBytes(info);
  return bytes + bytes / 256 + kPageOverhead * uint64_t(info.size.z) > kMaxClassicBytes;
}

uint16_t sampleFormat(SampleType type) {
  switch (type) {
    case SampleType::int8:
    case SampleType::int16:
    case SampleType::int32:
      return SAMPLEFORMAT_INT;
    case SampleType::float32:
    case SampleType::float64:
      return SAMPLEFORMAT_IEEEFP;
    default:
      return SAMPLEFORMAT_UINT;
  }
}

class TiffWriter : public ImageWriter {
 public:
  TiffWriter(const std::string& path, const ImageInfo& info)
      : counter_(path, info), file_(path), tiff_(file_, needsBigTiff(info)) {}

  void write(int count, const void* samples) override {
    const char* slice = static_cast<const char*>(samples);
    const int first = counter_.written();
    counter_.add(count);
    for (int z = first; z < first + count; ++z, slice += sliceBytes(counter_.info())) {
      setTags(z);
      writePage(slice);
    }
  }

  void finish() override {
    counter_.finish();
    if (!TIFFFlush(tiff_.get())) tiff_.fail("cannot be written");
    tiff_.close();
    file_.commit();
  }

 private:
  void setTags(int z) {
    const ImageInfo& info = counter_.info();
    TIFF* tiff = tiff_.get();
    const uint64_t rowBytes = uint64_t(info.size.x) * sampleSize(info.type);
    rows_ = uint32_t(std::clamp<uint64_t>(kStripBytes / rowBytes, 1, uint64_t(info.size.y)));
    bool good = TIFFSetField(tiff, TIFFTAG_IMAGEWIDTH, uint32_t(info.size.x)) &&
                TIFFSetField(tiff, TIFFTAG_IMAGELENGTH, uint32_t(info.size.y)) &&
                TIFFSetField(tiff, TIFFTAG_SAMPLESPERPIXEL, 1) &&
                TIFFSetField(tiff, TIFFTAG_BITSPERSAMPLE, int(8 * sampleSize(info.type))) &&
                TIFFSetField(tiff, TIFFTAG_SAMPLEFORMAT, int(sampleFormat(info.type))) &&
                TIFFSetField(tiff, TIFFTAG_PHOTOMETRIC, PHOTOMETRIC_MINISBLACK) &&
                TIFFSetField(tiff, TIFFTAG_PLANARCONFIG, PLANARCONFIG_CONTIG) &&
                TIFFSetField(tiff, TIFFTAG_COMPRESSION, COMPRESSION_ADOBE_DEFLATE) &&
                TIFFSetField(tiff, TIFFTAG_ZIPQUALITY, kDeflateLevel) &&
                TIFFSetField(tiff, TIFFTAG_ROWSPERSTRIP, rows_);
    if (good && info.voxelSize) good = setCalibration(*info.voxelSize, z == 0);
    if (!good) tiff_.fail("cannot be written");
  }

  /// As ImageJ does, but for "images=": that would promise it samples in one piece.
  bool setCalibration(const VoxelSize& size, bool first) {
    const auto& [x, y, z] = size.edges();
    const double smallest = std::min({x, y, z});
    const bool small = smallest < 1e-7, large = smallest >= 1e-2;
    const std::string unit = small ? "nm" : large ? "mm" : "micron";
    const double perMeter = unitsPerMetre(unit).value();
    const std::string text =
        "ImageJ=1.53k\nunit=" + unit + "\nspacing=" + lengthIn(perMeter, z) + "\n";
    return TIFFSetField(tiff_.get(), TIFFTAG_XRESOLUTION, 1 / (x * perMeter)) &&
           TIFFSetField(tiff_.get(), TIFFTAG_YRESOLUTION, 1 / (y * perMeter)) &&
           TIFFSetField(tiff_.get(), TIFFTAG_RESOLUTIONUNIT, RESUNIT_NONE) &&
           (!first || TIFFSetField(tiff_.get(), TIFFTAG_IMAGEDESCRIPTION, text.c_str()));
  }

  void writePage(const char* slice) {
    const ImageInfo& info = counter_.info();
    const uint64_t rowBytes = uint64_t(info.size.x) * sampleSize(info.type);
    uint32_t strip = 0;
    for (uint32_t y = 0; y < uint32_t(info.size.y); y += rows_, ++strip) {
      const uint64_t rows = std::min(rows_, uint32_t(info.size.y) - y);
      // libtiff changes the buffer only to swap bytes, and files are written in native order.
      void* samples = const_cast<char*>(slice) + rowBytes * y;
      const tmsize_t bytes = tmsize_t(rowBytes * rows);
      if (TIFFWriteEncodedStrip(tiff_.get(), strip, samples, bytes) != bytes)
        tiff_.fail("cannot be written");
    }
    if (!TIFFWriteDirectory(tiff_.get())) tiff_.fail("cannot be written");
  }

  SliceCounter counter_;
  OutputStream file_;
  TiffHandle tiff_;
  uint32_t rows_ = 1;
};

}  // namespace

std::unique_ptr<ImageWriter> createTiff(const std::string& path, const ImageInfo& info) {
  return std::make_unique<TiffWriter>(path, info);
}

}  // namespace vdb_madf::detail
