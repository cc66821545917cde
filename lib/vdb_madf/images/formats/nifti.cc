// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/images/formats/formats.h"

#include <cmath>
#include <cstring>
#include <vector>

#include "vdb_madf/base/detail/byte_order.h"
#include "vdb_madf/base/detail/text.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/base/length_unit.h"
#include "vdb_madf/files/detail/inflate_stream.h"
#include "vdb_madf/images/detail/header_checks.h"
#include "vdb_madf/images/detail/sample_conversion.h"
#include "vdb_madf/images/detail/stored_samples.h"
#include "vdb_madf/images/detail/stored_type.h"

namespace vdb_madf::detail {

namespace {

constexpr size_t kNiftiHeaderBytes = 348;
/// The header is followed by the four bytes of an extension.
constexpr double kMinOffset = 352;
/// Extensions (DICOM headers, say) lie before the samples.
constexpr double kMaxOffset = 1 << 26;
// Byte offsets in the header.
constexpr size_t kDim = 40, kDataTypeOffset = 70, kPixDim = 76, kVoxOffset = 108, kSlope = 112,
                 kIntercept = 116, kUnits = 123, kMagicOffset = 344;

bool isGzip(const InputFile& file) {
  return file.head(2) == "\x1f\x8b";
}

std::string headerBytes(const InputFile& file) {
  if (!isGzip(file)) return file.head(kNiftiHeaderBytes);
  std::string bytes(kNiftiHeaderBytes, '\0');
  InflateStream(file, 0).read(bytes.data(), bytes.size());
  return bytes;
}

bool hasMagic(const std::string& bytes, const char* magic) {
  return bytes.size() == kNiftiHeaderBytes && bytes.compare(kMagicOffset, 4, magic, 4) == 0;
}

class NiftiHeader {
 public:
  explicit NiftiHeader(const InputFile& file) : path_(file.name()), bytes_(headerBytes(file)) {
    if (hasMagic(bytes_, "ni1"))
      throw IoError(path_ + ": is a header without data: write both into one .nii file");
    if (!hasMagic(bytes_, "n+1")) throw IoError(path_ + ": is no NIfTI-1 file");
    int32_t size;
    std::memcpy(&size, bytes_.data(), sizeof size);
    bigEndian_ = size != int32_t(kNiftiHeaderBytes);
    if (number<int32_t>(0) != int32_t(kNiftiHeaderBytes))
      throw IoError(path_ + ": the NIfTI header does not begin with its size of 348 bytes");
  }

  bool bigEndian() const { return bigEndian_; }
  template <typename T>
  T number(size_t offset) const {
    T value;
    std::memcpy(&value, &bytes_[offset], sizeof value);
    if (bigEndian_) swapBytes(&value, 1, sizeof value);
    return value;
  }

  ImageSize size() const {
    const int dimensions = number<int16_t>(kDim);
    if (dimensions < 3 || dimensions > 7)
      throw IoError(path_ + ": has " + std::to_string(dimensions) +
                    " dimensions; only 3-D images can be read");
    for (int i = 4; i <= dimensions; ++i)
      if (dim(i) != 1)
        throw IoError(path_ + ": has " + std::to_string(dim(i)) + " volumes along dimension " +
                      std::to_string(i) + ": write one as a file of its own");
    return checkedSize(path_, {dim(1), dim(2), dim(3)});
  }

  StoredType type() const {
    const int code = number<int16_t>(kDataTypeOffset);
    for (const auto& [known, type, is64Bit] :
         {Code{2, SampleType::uint8, false}, Code{4, SampleType::int16, false},
          Code{8, SampleType::int32, false}, Code{16, SampleType::float32, false},
          Code{64, SampleType::float64, false}, Code{256, SampleType::int8, false},
          Code{512, SampleType::uint16, false}, Code{768, SampleType::uint32, false},
          Code{1024, SampleType::int32, true}, Code{1280, SampleType::uint32, true}})
      if (code == known) return {type, is64Bit, bigEndian_};
    throw IoError(path_ + ": its data type " + std::to_string(code) +
                  " cannot be read: write integers or floats");
  }

  void setSpacing(ImageInfo& info) const {
    std::optional<double> unit;
    const int code = static_cast<unsigned char>(bytes_[kUnits]) & 7;
    if (code == 1) unit = unitsPerMetre("m");
    if (code == 2) unit = unitsPerMetre("mm");
    if (code == 3) unit = unitsPerMetre("um");
    detail::setSpacing(info, path_, {edge(1), edge(2), edge(3)}, unit);
  }

  uint64_t offset() const {
    const double offset = double(number<float>(kVoxOffset));
    if (!(offset >= kMinOffset && offset <= kMaxOffset) || offset != std::floor(offset))
      throw IoError(path_ + ": its samples begin at byte " + shortestDecimal(offset) +
                    ", which cannot be: the NIfTI header is damaged");
    return uint64_t(offset);
  }

 private:
  struct Code {
    int number;
    SampleType type;
    bool is64Bit;
  };
  int dim(int axis) const { return number<int16_t>(kDim + 2 * size_t(axis)); }
  double edge(int axis) const {
    return std::abs(decimalOf(number<float>(kPixDim + 4 * size_t(axis))));
  }

  std::string path_, bytes_;
  bool bigEndian_ = false;
};

/// slope * sample + intercept.
class ScaledReader : public ImageReader {
 public:
  ScaledReader(std::unique_ptr<ImageReader> stored, double slope, double intercept)
      : stored_(std::move(stored)), slope_(slope), intercept_(intercept) {
    path_ = stored_->path();
    files_ = stored_->files();
    info_ = stored_->info();
    const SampleType type = info_.type;
    const bool isWide = type == SampleType::int32 || type == SampleType::uint32 ||
                        type == SampleType::float64;  // labels would merge in floats
    info_.type = isWide ? SampleType::float64 : SampleType::float32;
  }

  void read(int first, int count, void* samples) override {
    checkSlices(path_, info_, first, count);
    if (info_.type == SampleType::float64)
      scale(first, count, static_cast<double*>(samples));
    else
      scale(first, count, static_cast<float*>(samples));
  }

 private:
  template <typename Sample>
  void scale(int first, int count, Sample* to) {
    const size_t slice = size_t(info_.size.x) * size_t(info_.size.y);
    std::vector<char> buffer(size_t(sliceBytes(stored_->info())));
    for (int z = first; z < first + count; ++z, to += slice) {
      stored_->read(z, 1, buffer.data());
      withSampleType(stored_->info().type, [&](auto type) {
        const auto* values = reinterpret_cast<const decltype(type)*>(buffer.data());
        for (size_t i = 0; i < slice; ++i) to[i] = Sample(slope_ * double(values[i]) + intercept_);
      });
    }
  }

  std::unique_ptr<ImageReader> stored_;
  double slope_, intercept_;
};

}  // namespace

bool isNifti(const InputFile& file) {
  try {
    const std::string bytes = headerBytes(file);
    return hasMagic(bytes, "n+1") || hasMagic(bytes, "ni1");
  } catch (const IoError&) {  // another compressed file, or a damaged one
    return false;
  }
}

std::unique_ptr<ImageReader> openNifti(std::unique_ptr<InputFile> file) {
  const std::string path = file->path();
  const NiftiHeader header(*file);
  const StoredType stored = header.type();
  ImageInfo info;
  info.format = "nifti";
  info.size = header.size();
  info.type = stored.type;
  header.setSpacing(info);
  SampleLayout layout;
  layout.deflated = isGzip(*file);
  (layout.deflated ? layout.skip : layout.offset) = header.offset();
  layout.bigEndian = stored.bigEndian;
  layout.is64Bit = stored.is64Bit;
  auto reader = openSamples(path, info, std::move(file), layout);
  // A slope of 0 means that there is none, by the definition of the format.
  const double slope = double(header.number<float>(kSlope)),
               intercept = double(header.number<float>(kIntercept));
  if (slope == 0 || !std::isfinite(slope) || !std::isfinite(intercept) ||
      (slope == 1 && intercept == 0))
    return reader;
  return std::make_unique<ScaledReader>(std::move(reader), slope, intercept);
}

}  // namespace vdb_madf::detail
