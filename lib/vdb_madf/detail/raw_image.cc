// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/detail/raw_image.h"

#include "vdb_madf/detail/byte_order.h"
#include "vdb_madf/detail/header_text.h"
#include "vdb_madf/detail/inflate_stream.h"
#include "vdb_madf/detail/output_stream.h"
#include "vdb_madf/detail/slice_counter.h"
#include "vdb_madf/errors.h"

namespace vdb_madf::detail {

namespace {

std::string describe(const ImageInfo& info) {
  return std::to_string(info.size.x()) + " x " + std::to_string(info.size.y()) + " x " +
         std::to_string(info.size.z()) + " " + sampleTypeName(info.type);
}

class SampleReader : public ImageReader {
 public:
  SampleReader(const std::string& path, const ImageInfo& info, std::unique_ptr<InputFile> data,
               const SampleLayout& layout)
      : data_(std::move(data)), layout_(layout) {
    path_ = path;
    files_ = {path, data_->path()};
    info_ = info;
  }

  void read(int first, int count, void* samples) override {
    checkSlices(path_, info_, first, count);
    const uint64_t slice = sliceBytes(info_);
    if (layout_.deflated)
      inflateSlices(first, count, samples);
    else
      data_->read(layout_.offset + slice * uint64_t(first), samples, size_t(slice) * size_t(count));
    if (layout_.bigEndian)
      swapBytes(samples, size_t(slice / sampleSize(info_.type)) * size_t(count),
                sampleSize(info_.type));
  }

 private:
  void inflateSlices(int first, int count, void* samples) {
    const uint64_t slice = sliceBytes(info_);
    if (!stream_ || first < next_) {
      stream_ = std::make_unique<InflateStream>(*data_, layout_.offset);
      stream_->skip(layout_.skip);
      next_ = 0;
    }
    stream_->skip(slice * uint64_t(first - next_));
    stream_->read(samples, size_t(slice) * size_t(count));
    next_ = first + count;
    if (next_ == info_.size.z()) stream_->expectEnd();
  }

  std::unique_ptr<InputFile> data_;
  SampleLayout layout_;
  std::unique_ptr<InflateStream> stream_;
  int next_ = 0;
};

class RawWriter : public ImageWriter {
 public:
  RawWriter(const std::string& path, const ImageInfo& info) : counter_(path, info), out_(path) {}
  void write(int count, const void* samples) override { out_.write(samples, counter_.add(count)); }
  void finish() override {
    counter_.finish();
    out_.close();
    out_.commit();
  }

 private:
  SliceCounter counter_;
  OutputStream out_;
};

}  // namespace

std::unique_ptr<ImageReader> openSamples(const std::string& path, const ImageInfo& info,
                                         std::unique_ptr<InputFile> data,
                                         const SampleLayout& layout) {
  SampleLayout place = layout;
  const uint64_t needed = imageBytes(info), size = data->size();
  if (place.atEnd && needed <= size) place.offset = size - needed;
  if (place.offset > size)
    throw IoError(data->name() + ": has " + std::to_string(size) +
                  " bytes, but its samples begin at " + std::to_string(place.offset));
  const uint64_t held = size - place.offset;
  if (place.deflated) {
    const uint64_t most = held * InflateStream::kMostExpansion;
    if (place.skip > most || needed > most - place.skip)
      throw IoError(data->name() + ": has " + std::to_string(held) +
                    " compressed bytes, too few for " + describe(info));
  } else if (held != needed) {
    throw IoError(data->name() + ": has " + std::to_string(held) + " bytes of samples, but " +
                  describe(info) + " takes " + std::to_string(needed) +
                  ": check the size, the sample type and whether there is a header to skip");
  }
  return std::make_unique<SampleReader>(path, info, std::move(data), place);
}

std::unique_ptr<ImageReader> openRaw(const std::string& path, const RawLayout& layout) {
  ImageInfo info;
  info.size = checkedSize(path, {layout.size.x(), layout.size.y(), layout.size.z()});
  info.type = layout.type;
  info.format = "raw";
  SampleLayout samples;
  samples.bigEndian = layout.bigEndian;
  auto data = std::make_unique<InputFile>(path);
  const uint64_t needed = imageBytes(info);
  for (const SampleType other :
       {SampleType::uint8, SampleType::uint16, SampleType::int32, SampleType::float64})
    if (data->size() != needed &&
        data->size() == needed / sampleSize(info.type) * sampleSize(other))
      throw IoError(path + ": has " + std::to_string(data->size()) + " bytes, but " +
                    describe(info) + " takes " + std::to_string(needed) +
                    ": the size fits samples of " + std::to_string(sampleSize(other)) +
                    " bytes: give another type");
  return openSamples(path, info, std::move(data), samples);
}

std::unique_ptr<ImageWriter> createRaw(const std::string& path, const ImageInfo& info) {
  return std::make_unique<RawWriter>(path, info);
}

}  // namespace vdb_madf::detail
