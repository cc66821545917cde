// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "vdb_madf/images/detail/stored_type.h"
#include "vdb_madf/images/formats/zarr_codecs.h"
#include "vdb_madf/images/image.h"

namespace vdb_madf::detail {

/// Files that hold many chunks each, with an index of where they lie.
struct ZarrShards {
  ImageSize shape;  ///< voxels of a shard; a multiple of the chunk's
  bool indexAtStart = false, indexBigEndian = false;
  int indexSums = 0;  ///< checksums behind the index
};

/// What the description of an array says: .zarray of Zarr version 2, zarr.json of version 3.
struct ZarrDescription {
  size_t leading = 0;     ///< axes before the last three, all of length 1
  ImageSize size, chunk;  ///< of these three; chunk: what is coded by itself
  StoredType stored;
  std::array<char, 8> fill{};        ///< one sample: that of chunks which are not there
  std::array<uint64_t, 3> stride{};  ///< samples from one voxel of a chunk to the next, x, y, z
  ZarrCodec codec;
  bool isSharded = false;
  ZarrShards shards;
  std::string keyPrefix;  ///< what names of chunks begin with, "c/"
  char separator = '.';

  uint64_t chunkSamples() const {  // < 2^60
    return uint64_t(chunk.x) * uint64_t(chunk.y) * uint64_t(chunk.z);
  }
  uint64_t chunkBytes() const { return chunkSamples() * stored.bytes(); }
};

/// Reads a description of version 2. @param name for messages
/// @throw IoError for what is malformed or cannot be read
ZarrDescription readZarr2(const std::string& name, const std::string& path);
/// Reads a description of version 3. @throw the same
ZarrDescription readZarr3(const std::string& name, const std::string& path);

}  // namespace vdb_madf::detail
