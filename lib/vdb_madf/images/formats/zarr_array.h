// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "vdb_madf/images/formats/zarr_description.h"
#include "vdb_madf/images/image.h"

namespace vdb_madf::detail {

/// One array of a Zarr store on disk, [z, y, x], maybe behind axes of length 1: its description
/// (.zarray of version 2, zarr.json of version 3) and its chunks.
/// Version 2: no compressor, blosc, zlib, gzip, zstd; no filters. Version 3: regular grids of
/// chunks, keys `default` and `v2`, codecs transpose, bytes, sharding_indexed (alone, and not
/// within another), at most one of gzip, zstd and blosc, and crc32c.
/// Source: Zarr storage specification version 2, codecs as in numcodecs; Zarr core specification
/// version 3 and its codecs.
class ZarrArray {
 public:
  /// @param name for messages: the path the user gave
  /// @throw IoError if the description cannot be used, or so few chunks are there that the array is
  ///     not what it says (an absent chunk means that all of it is the fill value)
  ZarrArray(const std::string& name, const std::string& folder);

  /// True if there is a description of an array. @throw IoError for a zarr.json that is no JSON
  static bool isThere(const std::string& name, const std::string& folder);

  /// The axes before the last three, all of length 1.
  size_t leadingAxes() const { return array_.leading; }
  const ImageSize& size() const { return array_.size; }
  SampleType type() const { return array_.stored.type; }
  const std::string& descriptionPath() const { return descriptionPath_; }

  /// Slices [first, first + count), x fastest, native byte order; chunks are decoded in parallel.
  /// They should begin and end between chunks, or chunks are decoded for nothing.
  void read(int first, int count, char* samples) const;
  int slicesPerChunk() const { return array_.chunk.z; }

 private:
  using ChunkNumber = std::array<int, 3>;  ///< x, y, z

  /// The places of the chunks of a shard: offset and length, x fastest.
  struct Place {
    uint64_t offset = 0, length = 0;
    bool isThere() const { return ~offset != 0 || ~length != 0; }
  };

  void checkPresence() const;
  uint64_t chunksIn(const std::string& path) const;
  std::string chunkPath(const ChunkNumber& number) const;
  std::vector<Place> readIndex(const InputFile& shard) const;
  void readShard(const ChunkNumber& shard, int first, int count, char* samples) const;
  /// Reads one chunk's part of the slices; a piece that is not there is the fill value.
  void readChunk(const ChunkNumber& chunk, const std::optional<StoredPiece>& piece, int first,
                 int count, char* samples) const;
  /// Chunks beyond this size are decoded one after the other, for the memory they take.
  size_t chunksAtATime(size_t all) const;

  std::string name_, folder_, descriptionPath_;
  ZarrDescription array_;
};

}  // namespace vdb_madf::detail
