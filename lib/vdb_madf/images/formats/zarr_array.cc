// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/images/formats/zarr_array.h"

#include <blosc.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <limits>

#include "vdb_madf/base/detail/parallel.h"
#include "vdb_madf/base/detail/text.h"
#include "vdb_madf/base/limits.h"
#include "vdb_madf/files/detail/inflate_stream.h"
#include "vdb_madf/images/detail/json_text.h"
#include "vdb_madf/images/detail/sample_conversion.h"

namespace vdb_madf::detail {

namespace {

/// Blosc and numcodecs count in 31 bits.
constexpr uint64_t kMaxChunkBytes = (uint64_t(1) << 31) - 1;
/// Chunks beyond this are decoded one after the other, for the memory they take.
constexpr uint64_t kLargeChunk = uint64_t(1) << 26;
/// The most that any of blosc's codecs makes of a byte: zstd's runs, 128 KiB in four bytes.
constexpr uint64_t kMaxBloscExpansion = uint64_t(1) << 15;
/// Of so many chunks one at least has to be there.
constexpr uint64_t kMaxChunksPerStored = 4096;
constexpr uint64_t kMaxSide = kMaxImageSide;

/// The axes of a shape: x, y, z of the last three, the others have to be 1.
ImageSize lastThree(const std::string& name, const char* key, const Json& shape) {
  std::string text = shape.dump(-1, ' ', true);
  if (!shape.is_array() || shape.size() < 3 || shape.size() > 8)
    throw IoError(name + ": its " + key + " " + detail::quoted(text) +
                      " is not that of a volume: choose another array",
                  Hint::dataset);
  ImageSize last;
  for (size_t i = 0; i < shape.size(); ++i) {
    const Json& length = shape[i];
    if (!length.is_number_unsigned() || length.get<uint64_t>() < 1 ||
        length.get<uint64_t>() > kMaxSide)
      throw IoError(name + ": its " + key + " " + detail::quoted(text) + " is not within 1 .. " +
                    std::to_string(kMaxSide) + " a side");
    const auto n = length.get<uint64_t>();
    if (i + 3 >= shape.size())
      last[int(shape.size() - 1 - i)] = int(n);
    else if (n != 1)
      throw IoError(name + ": has " + std::to_string(n) + " volumes along axis " +
                    std::to_string(i) + ": save one as an array of its own");
  }
  return last;
}

/// The fill value as a sample; null and what is absent are 0.
template <typename T>
bool fillSample(const Json& fill, T& sample) {
  sample = T(0);
  if (fill.is_null()) return true;
  if (fill.is_boolean()) {
    sample = T(fill.get<bool>());
    return true;
  }
  if constexpr (std::is_floating_point_v<T>) {
    const std::string text = textOf(fill);
    if (text == "NaN") sample = std::numeric_limits<T>::quiet_NaN();
    if (text == "Infinity") sample = std::numeric_limits<T>::infinity();
    if (text == "-Infinity") sample = -std::numeric_limits<T>::infinity();
    if (!text.empty()) return sample != 0;
  }
  if (!fill.is_number()) return false;
  const double value = fill.get<double>();
  if (!fits<T>(value)) return false;
  sample = T(value);
  return true;
}

}  // namespace

ZarrArray::ZarrArray(const std::string& name, const std::string& folder)
    : name_(name), folder_(folder) {
  const Json json = jsonObject(name, descriptionPath());
  if (member(json, "zarr_format") != 2)
    throw IoError(name + ": is no Zarr array of version 2, which alone can be read");
  const Json& shape = member(json, "shape");
  size_ = lastThree(name, "shape", shape);
  chunk_ = lastThree(name, "chunks", member(json, "chunks"));
  leading_ = shape.size() - 3;
  if (member(json, "chunks").size() != shape.size())
    throw IoError(name + ": its shape and its chunks have different numbers of axes");
  const Json& type = member(json, "dtype");
  const auto stored = storedTypeFromNumpy(textOf(type));
  if (!stored)
    throw IoError(name + ": its type " + detail::quoted(type.dump(-1, ' ', true)) +
                  " cannot be read: save integers, bool, float32 or float64");
  stored_ = *stored;
  const Json &compressor = member(json, "compressor"), &filters = member(json, "filters");
  const std::string codec = textOf(member(compressor, "id"));
  if (codec == "blosc")
    codec_ = Codec::blosc;
  else if (codec == "zlib" || codec == "gzip")
    codec_ = Codec::deflate;
  else if (!compressor.is_null())
    throw IoError(name + ": its compressor " + detail::quoted(codec) +
                  " cannot be read; only blosc, zlib and gzip");
  if (!filters.is_null() && !(filters.is_array() && filters.empty()))
    throw IoError(name + ": has filters, which cannot be undone: save it without");
  zFastest_ = textOf(member(json, "order")) == "F";
  separator_ = textOf(member(json, "dimension_separator")) == "/" ? '/' : '.';
  const bool filled = withSampleType(stored_.type, [&](auto sample) {
    const bool good = fillSample(member(json, "fill_value"), sample);
    std::memcpy(fill_.data(), &sample, sizeof sample);
    return good;
  });
  if (!filled)
    throw IoError(name + ": its fill value " +
                  detail::quoted(member(json, "fill_value").dump(-1, ' ', true)) + " is no " +
                  sampleTypeName(stored_.type));
  if (chunkSamples() > kMaxChunkBytes / stored_.bytes())
    throw IoError(name + ": its chunks are larger than 2 GB");
  checkPresence();
}

uint64_t ZarrArray::chunkSamples() const {  // < 2^60
  return uint64_t(chunk_.x) * uint64_t(chunk_.y) * uint64_t(chunk_.z);
}

void ZarrArray::checkPresence() const {
  uint64_t present = 0;
  std::error_code error;
  for (std::filesystem::recursive_directory_iterator entry(folder_, error), end;
       !error && entry != end; entry.increment(error))
    present += entry->path().filename().string()[0] != '.' && !entry->is_directory(error);
  const uint64_t samples = uint64_t(size_.x) * uint64_t(size_.y) * uint64_t(size_.z);
  if (samples / kMaxChunksPerStored > present * chunkSamples() || present == 0)
    throw IoError(name_ + ": has " + std::to_string(present) +
                  " chunks, too few for its shape: is a part missing?");
}

std::string ZarrArray::chunkPath(const ChunkNumber& chunk) const {
  std::string key;
  for (size_t i = 0; i < leading_; ++i) key += std::string("0") + separator_;
  key += std::to_string(chunk[2]) + separator_ + std::to_string(chunk[1]) + separator_;
  return folder_ + "/" + key + std::to_string(chunk[0]);
}

bool ZarrArray::decode(const ChunkNumber& chunk, std::vector<char>& stored) const {
  const std::string path = chunkPath(chunk);
  std::error_code error;
  if (!std::filesystem::exists(path, error) && !error) return false;
  const InputFile file(name_, path);
  const uint64_t bytes = chunkSamples() * stored_.bytes();
  const auto fail = [&](uint64_t held) {
    throw IoError(file.name() + ": holds " + std::to_string(held) + " bytes of samples, but " +
                  std::to_string(bytes) + " are in a chunk");
  };
  if (codec_ == Codec::none) {
    if (file.size() != bytes) fail(file.size());
    stored.resize(size_t(bytes));
    file.read(0, stored.data(), stored.size());
  } else if (codec_ == Codec::deflate) {
    if (bytes > file.size() * InflateStream::kMaxExpansion) fail(file.size());
    stored.resize(size_t(bytes));
    InflateStream stream(file, 0);
    stream.read(stored.data(), stored.size());
    stream.expectEnd();
  } else {
    if (file.size() > kMaxChunkBytes) fail(file.size());
    const std::string coded = file.head(size_t(file.size()));
    size_t held = 0;
    if (coded.size() < BLOSC_MIN_HEADER_LENGTH ||
        blosc_cbuffer_validate(coded.data(), coded.size(), &held) != 0)
      throw IoError(file.name() + ": the blosc data are damaged");
    if (held != bytes || bytes > file.size() * kMaxBloscExpansion) fail(held);
    stored.resize(size_t(bytes));
    if (blosc_decompress_ctx(coded.data(), stored.data(), stored.size(), 1) != int(bytes))
      throw IoError(file.name() + ": the blosc data are damaged");
  }
  return true;
}

void ZarrArray::readChunk(const ChunkNumber& chunk, int first, int count, char* samples) const {
  std::vector<char> content;
  const bool present = decode(chunk, content);
  const size_t bytes = sampleSize(stored_.type);
  const int beginX = chunk[0] * chunk_.x, beginY = chunk[1] * chunk_.y,
            beginZ = std::max(chunk[2] * chunk_.z, first);
  // 64 bits: the last chunk may reach beyond 2^31.
  const int endX = int(std::min<int64_t>(size_.x, int64_t(beginX) + chunk_.x)),
            endY = int(std::min<int64_t>(size_.y, int64_t(beginY) + chunk_.y)),
            endZ =
                int(std::min<int64_t>(int64_t(first) + count, (int64_t(chunk[2]) + 1) * chunk_.z));
  const size_t nx = size_t(chunk_.x), ny = size_t(chunk_.y), nz = size_t(chunk_.z);
  const size_t strideX = zFastest_ ? ny * nz : 1, strideY = zFastest_ ? nz : nx,
               strideZ = zFastest_ ? 1 : nx * ny;
  const size_t width = size_t(endX - beginX);
  for (int z = beginZ; z < endZ; ++z)
    for (int y = beginY; y < endY; ++y) {
      char* to = samples + ((size_t(z - first) * size_t(size_.y) + size_t(y)) * size_t(size_.x) +
                            size_t(beginX)) *
                               bytes;
      const size_t from = size_t(z - chunk[2] * chunk_.z) * strideZ + size_t(y - beginY) * strideY;
      // What lies beyond the array is padding, whatever its values: it is not looked at.
      if (present && strideX == 1)
        toSamples(name_, stored_, &content[from * stored_.bytes()], width, to);
      else
        for (size_t x = 0; x < width; ++x, to += bytes)
          if (present)
            toSamples(name_, stored_, &content[(from + x * strideX) * stored_.bytes()], 1, to);
          else
            std::memcpy(to, fill_.data(), bytes);
    }
}

void ZarrArray::read(int first, int count, char* samples) const {
  if (count == 0) return;
  const auto chunksOf = [](int size, int chunk) {
    return size_t((int64_t(size) + chunk - 1) / chunk);
  };
  const size_t nx = chunksOf(size_.x, chunk_.x), ny = chunksOf(size_.y, chunk_.y);
  const int firstZ = first / chunk_.z, lastZ = (first + count - 1) / chunk_.z;
  const size_t all = nx * ny * size_t(lastZ - firstZ + 1);
  const size_t grain = chunkSamples() * stored_.bytes() > kLargeChunk ? all : 1;
  parallelFor(all, grain, nullptr, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i)
      readChunk({int(i % nx), int(i / nx % ny), firstZ + int(i / nx / ny)}, first, count, samples);
  });
}

}  // namespace vdb_madf::detail
