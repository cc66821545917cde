// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/images/formats/formats.h"

#include <optional>
#include <utility>
#include <vector>

#include "vdb_madf/base/detail/text.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/base/length_unit.h"
#include "vdb_madf/base/lower_case.h"
#include "vdb_madf/images/detail/compound_file.h"
#include "vdb_madf/images/detail/header_checks.h"

namespace vdb_madf::detail {

namespace {

/// Slices in a storage.
constexpr int kSlicesAStorage = 100;
/// Acquisition mode of projections; reconstructions have 10.
constexpr int32_t kTomography = 0;

/// (8 and 9, "long", are of another length on each system.)
std::optional<SampleType> typeOf(int32_t number) {
  switch (number) {
    case 2:
      return SampleType::int8;
    case 3:
      return SampleType::uint8;
    case 4:
      return SampleType::int16;
    case 5:
      return SampleType::uint16;
    case 6:
      return SampleType::int32;
    case 7:
      return SampleType::uint32;
    case 10:
      return SampleType::float32;
    case 11:
      return SampleType::float64;
    default:
      return std::nullopt;
  }
}

/// From 0.
std::string nameOfSlice(int slice) {
  return "ImageData" + std::to_string(slice / kSlicesAStorage + 1) + "/Image" +
         std::to_string(slice + 1);
}

class TxmReader : public ImageReader {
 public:
  explicit TxmReader(std::unique_ptr<InputFile> file) : file_(std::move(file)) {
    path_ = file_.file().path();
    files_ = {path_};
    info_.format = "txm";
    info_.size =
        checkedSize(path_, {require("ImageWidth"), require("ImageHeight"), require("NoOfImages")});
    const int32_t type = require("DataType");
    const auto known = typeOf(type);
    if (!known)
      throw IoError(path_ + ": its samples are of type " + std::to_string(type) +
                    ", which cannot be read: export integers of 8, 16 or 32 bits, or floats");
    info_.type = *known;
    if (imageBytes(info_) > file_.file().size())
      throw IoError(path_ + ": is too small for " + std::to_string(info_.size.z) + " slices of " +
                    std::to_string(sliceBytes(info_)) + " bytes: it is damaged or cut short");
    for (int z = 0; z < info_.size.z; ++z) slices_.push_back(slice(z));
    if (const auto edge = number<float>("PixelSize")) {
      const double um = decimalOf(*edge);
      info_.voxelSize = checkedVoxelSize(path_, {um, um, um}, unitsPerMetre("um"));
    }
    if (number<int32_t>("AcquisitionMode") == kTomography)
      notes_.push_back(path_ + ": seems to hold projections, not a volume: reconstruct it first");
  }

  void read(int first, int count, void* samples) override {
    checkSlices(path_, info_, first, count);
    char* to = static_cast<char*>(samples);
    for (int z = first; z < first + count; ++z, to += sliceBytes(info_))
      file_.read(slices_[size_t(z)], to, sliceBytes(info_));
  }

 private:
  /// The first number of a stream about the image.
  template <typename T>
  std::optional<T> number(const std::string& name) const {
    const CompoundFile::Stream* stream = file_.find(lowerCase("ImageInfo/" + name));
    if (!stream) return std::nullopt;
    T value;
    if (stream->bytes < sizeof value)
      throw IoError(path_ + ": the stream ImageInfo/" + name + " is too short for a number");
    file_.read(*stream, &value, sizeof value);
    return value;
  }

  int32_t require(const std::string& name) const {
    const auto value = number<int32_t>(name);
    if (!value)
      throw IoError(path_ + ": has no stream ImageInfo/" + name +
                    ": it is damaged, or a compound file that is no TXM scan");
    return *value;
  }

  CompoundFile::Stream slice(int z) const {
    const std::string name = nameOfSlice(z);
    const CompoundFile::Stream* stream = file_.find(lowerCase(name));
    if (!stream) throw IoError(path_ + ": has no stream " + name + ": slices are missing");
    if (stream->bytes != sliceBytes(info_))
      throw IoError(path_ + ": the stream " + name + " has " + std::to_string(stream->bytes) +
                    " bytes, and a slice " + std::to_string(sliceBytes(info_)));
    return *stream;
  }

  CompoundFile file_;
  std::vector<CompoundFile::Stream> slices_;
};

}  // namespace

bool isCompoundHeader(const std::string& head) {
  return head.compare(0, 8, "\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1") == 0;
}

std::unique_ptr<ImageReader> openTxm(std::unique_ptr<InputFile> file) {
  return std::make_unique<TxmReader>(std::move(file));
}

}  // namespace vdb_madf::detail
