// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/images/detail/stored_samples.h"

#include <algorithm>
#include <vector>

#include "vdb_madf/base/errors.h"
#include "vdb_madf/files/detail/inflate_stream.h"
#include "vdb_madf/files/detail/output_stream.h"
#include "vdb_madf/images/detail/header_checks.h"
#include "vdb_madf/images/detail/slice_counter.h"
#include "vdb_madf/images/detail/stored_type.h"

namespace vdb_madf::detail {

namespace {

/// How many 64-bit integers are narrowed at a time.
constexpr size_t kSamplesPerPiece = size_t(1) << 16;

uint64_t storedBytes(const ImageInfo& info, const SampleLayout& layout) {
  return layout.is64Bit ? imageBytes(info) * 2 : imageBytes(info);
}

class SampleReader : public ImageReader {
 public:
  SampleReader(const std::string& path, const ImageInfo& info, std::unique_ptr<InputFile> data,
               const SampleLayout& layout, const std::vector<std::string>& otherFiles)
      : data_(std::move(data)),
        layout_(layout),
        stored_{info.type, layout.is64Bit, layout.bigEndian} {
    path_ = path;
    files_ = {path, data_->path()};
    files_.insert(files_.end(), otherFiles.begin(), otherFiles.end());
    info_ = info;
  }

  void read(int first, int count, void* samples) override {
    checkSlices(path_, info_, first, count);
    const uint64_t slice = uint64_t(info_.size.x) * uint64_t(info_.size.y);
    moveTo(slice * uint64_t(first));
    const size_t all = size_t(slice) * size_t(count);
    if (layout_.is64Bit) {
      std::vector<char> piece(std::min(all, kSamplesPerPiece) * stored_.bytes());
      char* next = static_cast<char*>(samples);
      for (size_t left = all; left > 0;) {
        const size_t some = std::min(left, kSamplesPerPiece);
        readStored(piece.data(), some);
        toSamples(path_, stored_, piece.data(), some, next);
        next += some * sampleSize(info_.type);
        left -= some;
      }
    } else {
      readStored(samples, all);
      toSamples(path_, stored_, samples, all, samples);
    }
    if (stream_ && first + count == info_.size.z) stream_->expectEnd();
  }

 private:
  void moveTo(uint64_t sample) {
    if (layout_.deflated) {
      if (!stream_ || sample < next_) {
        stream_ = std::make_unique<InflateStream>(*data_, layout_.offset);
        stream_->skip(layout_.skip);
        next_ = 0;
      }
      stream_->skip((sample - next_) * stored_.bytes());
    }
    next_ = sample;
  }

  void readStored(void* to, size_t count) {
    const size_t bytes = count * stored_.bytes();
    if (stream_)
      stream_->read(to, bytes);
    else
      data_->read(layout_.offset + next_ * stored_.bytes(), to, bytes);
    next_ += count;
  }

  std::unique_ptr<InputFile> data_;
  SampleLayout layout_;
  StoredType stored_;
  std::unique_ptr<InflateStream> stream_;
  uint64_t next_ = 0;  ///< sample
};

class SampleWriter : public ImageWriter {
 public:
  SampleWriter(const std::string& path, const ImageInfo& info, const std::string& header)
      : counter_(path, info), out_(path), header_(header.size()) {
    out_.text(header);
  }
  void write(int count, const void* samples) override { out_.bytes(samples, counter_.add(count)); }
  void finish() override {
    counter_.finish();
    out_.commit();
  }
  std::optional<SharedImage> share() override {
    return detail::shareSamples(counter_, out_, header_);
  }

 private:
  SliceCounter counter_;
  OutputStream out_;
  uint64_t header_;  // bytes
};

}  // namespace

std::string describe(const ImageInfo& info) {
  return std::to_string(info.size.x) + " x " + std::to_string(info.size.y) + " x " +
         std::to_string(info.size.z) + " " + sampleTypeName(info.type);
}

std::unique_ptr<ImageReader> openSamples(const std::string& path, const ImageInfo& info,
                                         std::unique_ptr<InputFile> data,
                                         const SampleLayout& layout,
                                         const std::vector<std::string>& otherFiles) {
  SampleLayout exact = layout;
  const uint64_t needed = storedBytes(info, layout), size = data->size();
  if (exact.atEnd && needed <= size) exact.offset = size - needed;
  if (exact.offset > size)
    throw IoError(data->name() + ": has " + std::to_string(size) +
                  " bytes, but its samples begin at " + std::to_string(exact.offset));
  const uint64_t available = size - exact.offset;
  if (exact.deflated) {
    const uint64_t maxInflated = available * InflateStream::kMaxExpansion;
    if (exact.skip > maxInflated || needed > maxInflated - exact.skip)
      throw IoError(data->name() + ": has " + std::to_string(available) +
                    " compressed bytes, too few for " + describe(info));
  } else if (available < needed || available - needed > exact.maxPadding) {
    throw IoError(data->name() + ": has " + std::to_string(available) + " bytes of samples, but " +
                  describe(info) + " takes " + std::to_string(needed) +
                  ": check the size, the sample type and whether there is a header to skip");
  }
  return std::make_unique<SampleReader>(path, info, std::move(data), exact, otherFiles);
}

std::optional<SharedImage> shareSamples(SliceCounter& counter, OutputStream& out, uint64_t header) {
  const auto temporary = out.share(header + imageBytes(counter.info()));
  if (!temporary) return std::nullopt;
  counter.add(counter.info().size.z);
  return SharedImage{*temporary, header};
}

std::unique_ptr<ImageWriter> createSamples(const std::string& path, const ImageInfo& info,
                                           const std::string& header) {
  return std::make_unique<SampleWriter>(path, info, header);
}

}  // namespace vdb_madf::detail
