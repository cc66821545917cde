// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "vdb_madf/files/detail/input_file.h"

namespace vdb_madf::detail {

/// Blosc and numcodecs count in 31 bits; checksums want room.
constexpr uint64_t kMaxZarrChunkBytes = (uint64_t(1) << 31) - 64;

/// The way from the bytes of a chunk to what is stored: checksums (CRC-32C, 4 bytes behind the
/// others), at most one compressor, checksums of what that makes.
struct ZarrCodec {
  enum class Compressor { none, blosc, deflate, zstd };
  Compressor compressor = Compressor::none;
  int innerSums = 0, outerSums = 0;
};

/// Part of a file.
struct StoredPiece {
  const InputFile* file = nullptr;
  uint64_t offset = 0, length = 0;  ///< within the file
};

/// The `bytes` bytes that a piece stands for; more are never allocated than it can hold.
/// @throw IoError
std::vector<char> decodePiece(const StoredPiece& piece, const ZarrCodec& codec, uint64_t bytes);

/// Removes checksums from the end, the last first. @throw IoError if one is wrong or missing
void checkSums(const std::string& name, int sums, std::vector<char>& bytes);

}  // namespace vdb_madf::detail
