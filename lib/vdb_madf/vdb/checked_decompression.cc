// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

// OpenVDB before 11 reads a compressed block into its buffer before it compares the size that the
// file gives with the size of the buffer: one wrong bit overflows the heap. Later ones take some
// wrong sizes for right. These functions check first. They carry the names of the library's own, so
// that a program that they are linked into uses them instead, in the library's code too: the
// dynamic linker takes the program's definition.

#include <blosc.h>
#include <openvdb/Exceptions.h>
#include <openvdb/io/Compression.h>
#include <zlib.h>

#include <cstdint>
#include <istream>
#include <limits>
#include <vector>

namespace {

/// The block's size as stored, negative or zero for bytes that are not compressed.
int64_t readBlockSize(std::istream& stream) {
  int64_t size = 0;
  if (!stream.read(reinterpret_cast<char*>(&size), sizeof(size)))
    OPENVDB_THROW(openvdb::IoError, "checked decompression: the file ends early");
  return size;
}

void require(bool condition) {
  if (!condition)
    OPENVDB_THROW(openvdb::IoError, "checked decompression: a compressed block is damaged");
}

/// The next bytes of the file, or over them where there is no buffer.
void readOrSkip(std::istream& stream, char* data, int64_t size) {
  if (data) {
    stream.read(data, std::streamsize(size));
  } else {
    stream.seekg(std::streamoff(size), std::ios_base::cur);
  }
  if (!stream) OPENVDB_THROW(openvdb::IoError, "checked decompression: the file ends early");
}

/// True if the block was not compressed and is dealt with.
bool readStored(std::istream& stream, int64_t size, char* data, size_t bytes) {
  if (size > 0) return false;
  require(bytes <= size_t(std::numeric_limits<int64_t>::max()) && size == -int64_t(bytes));
  readOrSkip(stream, data, int64_t(bytes));
  return true;
}

}  // namespace

namespace openvdb {
OPENVDB_USE_VERSION_NAMESPACE
namespace OPENVDB_VERSION_NAME {
namespace io {

void bloscFromStream(std::istream& stream, char* data, size_t bytes) {
  const int64_t size = readBlockSize(stream);
  if (readStored(stream, size, data, bytes)) return;
  require(bytes <= size_t(BLOSC_MAX_BUFFERSIZE) && size >= BLOSC_MIN_HEADER_LENGTH &&
          size <= int64_t(bytes) + BLOSC_MAX_OVERHEAD);
  if (!data) return readOrSkip(stream, nullptr, size);
  std::vector<char> packed(static_cast<size_t>(size));
  readOrSkip(stream, packed.data(), size);
  size_t unpacked = 0;
  require(blosc_cbuffer_validate(packed.data(), packed.size(), &unpacked) == 0 &&
          unpacked == bytes);
  require(blosc_decompress_ctx(packed.data(), data, bytes, /*numinternalthreads=*/1) == int(bytes));
}

void unzipFromStream(std::istream& stream, char* data, size_t bytes) {
  const int64_t size = readBlockSize(stream);
  if (readStored(stream, size, data, bytes)) return;
  require(uint64_t(size) <= compressBound(uLong(bytes)));
  if (!data) return readOrSkip(stream, nullptr, size);
  std::vector<char> packed(static_cast<size_t>(size));
  readOrSkip(stream, packed.data(), size);
  uLongf unpacked = uLongf(bytes);
  require(uncompress(reinterpret_cast<Bytef*>(data), &unpacked,
                     reinterpret_cast<const Bytef*>(packed.data()), uLong(size)) == Z_OK &&
          unpacked == bytes);
}

}  // namespace io
}  // namespace OPENVDB_VERSION_NAME
}  // namespace openvdb
