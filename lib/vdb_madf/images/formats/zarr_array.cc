// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/images/formats/zarr_array.h"

#include <algorithm>
#include <cstring>
#include <filesystem>

#include "vdb_madf/base/detail/parallel.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/files/detail/input_file.h"
#include "vdb_madf/images/detail/json_text.h"

namespace vdb_madf::detail {

namespace {

namespace fs = std::filesystem;

/// Chunks beyond this are decoded one after the other, for the memory they take.
constexpr uint64_t kLargeChunk = uint64_t(1) << 26;
/// Of so many chunks one at least has to be there.
constexpr uint64_t kMaxChunksPerStored = 4096;
/// Of the index of a shard, for each chunk.
constexpr uint64_t kPlaceBytes = 16;

/// True also for what cannot be looked at: it says so when it is opened.
bool isFileThere(const std::string& path) {
  std::error_code error;
  return fs::exists(path, error) || error;
}

int ceilDiv(int a, int b) {
  return int((int64_t(a) + b - 1) / b);
}

uint64_t number64(const char* bytes, bool isBigEndian) {
  uint64_t value = 0;
  for (int i = 0; i < 8; ++i)
    value |= uint64_t(static_cast<unsigned char>(bytes[isBigEndian ? 7 - i : i])) << 8 * i;
  return value;
}

}  // namespace

bool ZarrArray::isThere(const std::string& name, const std::string& folder) {
  if (isFileThere(folder + "/.zarray")) return true;
  const std::string path = folder + "/zarr.json";
  return isFileThere(path) && member(jsonObjectWithoutLabels(name, path), "node_type") == "array";
}

ZarrArray::ZarrArray(const std::string& name, const std::string& folder)
    : name_(name), folder_(folder), descriptionPath_(folder + "/.zarray") {
  if (isFileThere(descriptionPath_)) {
    array_ = readZarr2(name, descriptionPath_);
  } else {
    descriptionPath_ = folder + "/zarr.json";
    array_ = readZarr3(name, descriptionPath_);
  }
  checkPresence();
}

void ZarrArray::checkPresence() const {
  const ImageSize& size = array_.size;
  const uint64_t samples = uint64_t(size.x) * uint64_t(size.y) * uint64_t(size.z);
  const auto suffices = [&](uint64_t chunks) {
    return chunks > 0 && samples / kMaxChunksPerStored <= chunks * array_.chunkSamples();
  };
  uint64_t present = 0;
  std::error_code error;
  for (fs::recursive_directory_iterator entry(folder_, error), end;
       !error && entry != end && !suffices(present); entry.increment(error)) {
    const std::string name = entry->path().filename().string();
    if (name[0] != '.' && name != "zarr.json" && !entry->is_directory(error))
      present += chunksIn(entry->path().string());
  }
  if (!suffices(present))
    throw IoError(name_ + ": has " + std::to_string(present) +
                  " chunks, too few for its shape: is a part missing?");
}

/// How many chunks a file holds.
uint64_t ZarrArray::chunksIn(const std::string& path) const {
  if (!array_.isSharded) return 1;
  const auto index = readIndex(InputFile(name_, path));
  return uint64_t(std::count_if(index.begin(), index.end(),
                                [](const Place& place) { return place.isThere(); }));
}

std::string ZarrArray::chunkPath(const ChunkNumber& number) const {
  std::string key = array_.keyPrefix;
  for (size_t i = 0; i < array_.leading; ++i) key += std::string("0") + array_.separator;
  key +=
      std::to_string(number[2]) + array_.separator + std::to_string(number[1]) + array_.separator;
  return folder_ + "/" + key + std::to_string(number[0]);
}

std::vector<ZarrArray::Place> ZarrArray::readIndex(const InputFile& shard) const {
  const ZarrShards& shards = array_.shards;
  uint64_t count = 1;  // < 2^60
  for (int axis = 0; axis < 3; ++axis) count *= uint64_t(shards.shape[axis] / array_.chunk[axis]);
  const uint64_t sums = 4 * uint64_t(shards.indexSums);
  if (count > shard.size() / kPlaceBytes || count * kPlaceBytes + sums > shard.size())
    throw IoError(shard.name() + ": is too short for the index of its " + std::to_string(count) +
                  " chunks");
  std::vector<char> bytes(size_t(count * kPlaceBytes + sums));
  shard.read(shards.indexAtStart ? 0 : shard.size() - bytes.size(), bytes.data(), bytes.size());
  checkSums(shard.name(), shards.indexSums, bytes);
  std::vector<Place> index(static_cast<size_t>(count));
  for (size_t i = 0; i < index.size(); ++i) {
    Place& place = index[i];
    place = {number64(&bytes[i * kPlaceBytes], shards.indexBigEndian),
             number64(&bytes[i * kPlaceBytes + 8], shards.indexBigEndian)};
    if (place.isThere() &&
        (place.length > shard.size() || place.offset > shard.size() - place.length))
      throw IoError(shard.name() + ": a chunk of its index lies beyond its end");
  }
  return index;
}

void ZarrArray::readChunk(const ChunkNumber& chunk, const std::optional<StoredPiece>& piece,
                          int first, int count, char* samples) const {
  const ImageSize &size = array_.size, &edges = array_.chunk;
  std::vector<char> content;
  if (piece) content = decodePiece(*piece, array_.codec, array_.chunkBytes());
  const size_t bytes = sampleSize(array_.stored.type);
  const int beginX = chunk[0] * edges.x, beginY = chunk[1] * edges.y,
            beginZ = std::max(chunk[2] * edges.z, first);
  // 64 bits: the last chunk may reach beyond 2^31.
  const int endX = int(std::min<int64_t>(size.x, int64_t(beginX) + edges.x)),
            endY = int(std::min<int64_t>(size.y, int64_t(beginY) + edges.y)),
            endZ =
                int(std::min<int64_t>(int64_t(first) + count, (int64_t(chunk[2]) + 1) * edges.z));
  const auto [strideX, strideY, strideZ] = array_.stride;
  const size_t width = size_t(endX - beginX);
  for (int z = beginZ; z < endZ; ++z)
    for (int y = beginY; y < endY; ++y) {
      char* to = samples + ((size_t(z - first) * size_t(size.y) + size_t(y)) * size_t(size.x) +
                            size_t(beginX)) *
                               bytes;
      const size_t from = size_t(z - chunk[2] * edges.z) * strideZ + size_t(y - beginY) * strideY;
      // What lies beyond the array is padding, whatever its values: it is not looked at.
      if (piece && strideX == 1)
        toSamples(name_, array_.stored, &content[from * array_.stored.bytes()], width, to);
      else
        for (size_t x = 0; x < width; ++x, to += bytes)
          if (piece)
            toSamples(name_, array_.stored, &content[(from + x * strideX) * array_.stored.bytes()],
                      1, to);
          else
            std::memcpy(to, array_.fill.data(), bytes);
    }
}

size_t ZarrArray::chunksAtATime(size_t all) const {
  return array_.chunkBytes() > kLargeChunk ? all : 1;
}

void ZarrArray::readShard(const ChunkNumber& shard, int first, int count, char* samples) const {
  const std::string path = chunkPath(shard);
  std::optional<InputFile> file;
  std::vector<Place> index;
  if (isFileThere(path)) {
    file.emplace(name_, path);
    index = readIndex(*file);
  }
  // The chunks of the shard that meet the slices, along each axis.
  const ImageSize &edges = array_.chunk, &shape = array_.shards.shape;
  std::array<int, 3> per{}, begin{}, end{};
  for (int axis = 0; axis < 3; ++axis) {
    const auto a = size_t(axis);
    per[a] = shape[axis] / edges[axis];
    begin[a] = shard[a] * per[a];
    end[a] =
        int(std::min<int64_t>(ceilDiv(array_.size[axis], edges[axis]), int64_t(begin[a]) + per[a]));
  }
  const int firstZ = std::max(begin[2], first / edges.z),
            endZ = std::min(end[2], (first + count - 1) / edges.z + 1);
  const size_t nx = size_t(end[0] - begin[0]), ny = size_t(end[1] - begin[1]),
               all = nx * ny * size_t(std::max(0, endZ - firstZ));
  parallelFor(all, chunksAtATime(all), nullptr, [&](size_t from, size_t to) {
    for (size_t i = from; i < to; ++i) {
      const ChunkNumber chunk{begin[0] + int(i % nx), begin[1] + int(i / nx % ny),
                              firstZ + int(i / nx / ny)};
      std::optional<StoredPiece> piece;
      if (file) {
        const size_t row =
            size_t(chunk[2] - begin[2]) * size_t(per[1]) + size_t(chunk[1] - begin[1]);
        const Place& place = index[row * size_t(per[0]) + size_t(chunk[0] - begin[0])];
        if (place.isThere()) piece = StoredPiece{&*file, place.offset, place.length};
      }
      readChunk(chunk, piece, first, count, samples);
    }
  });
}

void ZarrArray::read(int first, int count, char* samples) const {
  if (count == 0) return;
  const ImageSize& unit = array_.isSharded ? array_.shards.shape : array_.chunk;
  const size_t nx = size_t(ceilDiv(array_.size.x, unit.x)),
               ny = size_t(ceilDiv(array_.size.y, unit.y));
  const int firstZ = first / unit.z, lastZ = (first + count - 1) / unit.z;
  const size_t all = nx * ny * size_t(lastZ - firstZ + 1);
  const auto numberOf = [&](size_t i) {
    return ChunkNumber{int(i % nx), int(i / nx % ny), firstZ + int(i / nx / ny)};
  };
  if (array_.isSharded) {
    for (size_t i = 0; i < all; ++i) readShard(numberOf(i), first, count, samples);
    return;
  }
  parallelForEach(all, chunksAtATime(all), nullptr, [&](size_t i) {
    const ChunkNumber chunk = numberOf(i);
    const std::string path = chunkPath(chunk);
    if (!isFileThere(path)) {
      readChunk(chunk, std::nullopt, first, count, samples);
      return;
    }
    const InputFile file(name_, path);
    readChunk(chunk, StoredPiece{&file, 0, file.size()}, first, count, samples);
  });
}

}  // namespace vdb_madf::detail
