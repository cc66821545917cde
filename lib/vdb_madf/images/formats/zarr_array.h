// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "vdb_madf/images/detail/stored_type.h"
#include "vdb_madf/images/image.h"

namespace vdb_madf::detail {

/// One array of a Zarr version 2 store on disk, [z, y, x], maybe behind axes of length 1: its
/// description (.zarray) and its chunks. Compressors: none, blosc, zlib, gzip; no filters.
/// Source: Zarr storage specification version 2; codecs as in numcodecs.
class ZarrArray {
 public:
  /// @param name for messages: the path the user gave
  /// @throw IoError if the description cannot be used, or so few chunks are there that the array is
  ///     not what it says (an absent chunk means that all of it is the fill value)
  ZarrArray(const std::string& name, const std::string& folder);

  /// The axes before the last three, all of length 1.
  size_t leadingAxes() const { return leading_; }
  const ImageSize& size() const { return size_; }
  SampleType type() const { return stored_.type; }
  std::string descriptionPath() const { return folder_ + "/.zarray"; }

  /// Slices [first, first + count), x fastest, native byte order; chunks are decoded in parallel.
  /// They should begin and end between chunks, or chunks are decoded for nothing.
  void read(int first, int count, char* samples) const;
  int slicesPerChunk() const { return chunk_.z; }

 private:
  using ChunkNumber = std::array<int, 3>;  ///< x, y, z

  enum class Codec { none, blosc, deflate };

  void checkPresence() const;
  std::string chunkPath(const ChunkNumber& chunk) const;
  uint64_t chunkSamples() const;
  /// One chunk's part of the slices.
  void readChunk(const ChunkNumber& chunk, int first, int count, char* samples) const;
  /// The samples of a chunk as stored; false if it is absent.
  bool decode(const ChunkNumber& chunk, std::vector<char>& stored) const;

  std::string name_, folder_;
  size_t leading_ = 0;
  ImageSize size_, chunk_;  ///< x, y, z
  StoredType stored_;
  Codec codec_ = Codec::none;
  bool zFastest_ = false;  ///< order F
  char separator_ = '.';
  std::array<char, 8> fill_{};  ///< one sample
};

}  // namespace vdb_madf::detail
