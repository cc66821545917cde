// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/images/formats/zarr_codecs.h"

#include <blosc.h>
#include <zstd.h>

#include <array>

#include "vdb_madf/base/errors.h"
#include "vdb_madf/files/detail/inflate_stream.h"

namespace vdb_madf::detail {

namespace {

constexpr uint64_t kSumBytes = 4;
/// The most that zstd makes of a byte: runs, 128 KiB in four bytes. Blosc's codecs make no more.
constexpr uint64_t kMaxBloscExpansion = uint64_t(1) << 15;
/// No codec makes what cannot be compressed so much longer.
constexpr uint64_t kMaxOverhead = 4096;

/// Of each byte, for the reflected polynomial of Castagnoli.
constexpr std::array<uint32_t, 256> crc32cTable() {
  std::array<uint32_t, 256> table{};
  for (uint32_t i = 0; i < 256; ++i) {
    uint32_t sum = i;
    for (int bit = 0; bit < 8; ++bit) sum = sum >> 1 ^ (sum & 1 ? 0x82f63b78u : 0u);
    table[i] = sum;
  }
  return table;
}
constexpr std::array<uint32_t, 256> kCrc32c = crc32cTable();

uint32_t crc32c(const char* bytes, size_t count) {
  uint32_t sum = ~0u;
  for (size_t i = 0; i < count; ++i)
    sum = sum >> 8 ^ kCrc32c[(sum ^ static_cast<unsigned char>(bytes[i])) & 0xff];
  return ~sum;
}

[[noreturn]] void failToHold(const std::string& name, uint64_t held, uint64_t wanted) {
  throw IoError(name + ": holds " + std::to_string(held) + " bytes of samples, but " +
                std::to_string(wanted) + " are in a chunk");
}

/// Whole, without its outer checksums.
std::vector<char> codedBytes(const StoredPiece& piece, const ZarrCodec& codec, uint64_t bytes) {
  if (piece.length > 2 * bytes + kMaxOverhead) failToHold(piece.file->name(), piece.length, bytes);
  std::vector<char> coded(size_t(piece.length));
  piece.file->read(piece.offset, coded.data(), coded.size());
  checkSums(piece.file->name(), codec.outerSums, coded);
  return coded;
}

std::vector<char> fromBlosc(const std::string& name, const std::vector<char>& coded,
                            uint64_t bytes) {
  size_t held = 0;
  if (coded.size() < BLOSC_MIN_HEADER_LENGTH ||
      blosc_cbuffer_validate(coded.data(), coded.size(), &held) != 0)
    throw IoError(name + ": the blosc data are damaged");
  if (held != bytes || bytes > coded.size() * kMaxBloscExpansion) failToHold(name, held, bytes);
  std::vector<char> result(static_cast<size_t>(bytes));
  if (blosc_decompress_ctx(coded.data(), result.data(), result.size(), 1) != int(bytes))
    throw IoError(name + ": the blosc data are damaged");
  return result;
}

std::vector<char> fromZstd(const std::string& name, const std::vector<char>& coded,
                           uint64_t bytes) {
  if (bytes > coded.size() * kMaxBloscExpansion) failToHold(name, coded.size(), bytes);
  std::vector<char> result(static_cast<size_t>(bytes));
  const size_t made = ZSTD_decompress(result.data(), result.size(), coded.data(), coded.size());
  if (ZSTD_isError(made))
    throw IoError(name + ": the zstd data are damaged (" + ZSTD_getErrorName(made) + ")");
  if (made != bytes) failToHold(name, made, bytes);
  return result;
}

std::vector<char> inflated(const StoredPiece& piece, const ZarrCodec& codec, uint64_t bytes) {
  const uint64_t sums = kSumBytes * uint64_t(codec.outerSums);
  if (sums > 0) codedBytes(piece, codec, bytes);
  const uint64_t length = piece.length - sums;
  if (bytes > length * InflateStream::kMaxExpansion) failToHold(piece.file->name(), length, bytes);
  std::vector<char> result(static_cast<size_t>(bytes));
  InflateStream stream(*piece.file, piece.offset, piece.offset + length);
  stream.read(result.data(), result.size());
  stream.expectEnd();
  return result;
}

}  // namespace

void checkSums(const std::string& name, int sums, std::vector<char>& bytes) {
  for (; sums > 0; --sums) {
    if (bytes.size() < kSumBytes) throw IoError(name + ": ends before its checksum");
    const size_t length = bytes.size() - kSumBytes;
    uint32_t stored = 0;
    for (size_t i = 0; i < kSumBytes; ++i)
      stored |= uint32_t(static_cast<unsigned char>(bytes[length + i])) << 8 * i;
    if (stored != crc32c(bytes.data(), length))
      throw IoError(name + ": its checksum is wrong: the file is damaged");
    bytes.resize(length);
  }
}

std::vector<char> decodePiece(const StoredPiece& piece, const ZarrCodec& codec, uint64_t bytes) {
  const std::string& name = piece.file->name();
  const uint64_t withSums = bytes + kSumBytes * uint64_t(codec.innerSums);
  std::vector<char> result;
  switch (codec.compressor) {
    case ZarrCodec::Compressor::none:
      if (piece.length != withSums + kSumBytes * uint64_t(codec.outerSums))
        failToHold(name, piece.length, bytes);
      result = codedBytes(piece, codec, withSums);
      break;
    case ZarrCodec::Compressor::blosc:
      result = fromBlosc(name, codedBytes(piece, codec, withSums), withSums);
      break;
    case ZarrCodec::Compressor::zstd:
      result = fromZstd(name, codedBytes(piece, codec, withSums), withSums);
      break;
    case ZarrCodec::Compressor::deflate:
      result = inflated(piece, codec, withSums);
  }
  checkSums(name, codec.innerSums, result);
  return result;
}

}  // namespace vdb_madf::detail
