// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include <openvdb/Grid.h>
#include <openvdb/io/Compression.h>
#include <openvdb/io/Stream.h>
#include <openvdb/version.h>

#include <cstring>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include "support/catch.h"
#include "support/other_grids.h"
#include "vdb_madf/grids/grid_types.h"
#include "vdb_madf/segmentation/initialize.h"

using namespace vdb_madf;
namespace io = openvdb::io;

namespace {

enum class Codec { blosc, zip };

std::string packed(Codec codec, const std::string& bytes) {
  std::ostringstream stream;
  if (codec == Codec::blosc) {
    io::bloscToStream(stream, bytes.data(), 1, bytes.size());
  } else {
    io::zipToStream(stream, bytes.data(), bytes.size());
  }
  return stream.str();
}

/// The position after reading.
int64_t unpack(Codec codec, const std::string& block, char* data, size_t bytes) {
  std::istringstream stream(block + "tail");
  if (codec == Codec::blosc) {
    io::bloscFromStream(stream, data, bytes);
  } else {
    io::unzipFromStream(stream, data, bytes);
  }
  return stream.tellg();
}

std::string compressible(size_t bytes) {
  std::string text(bytes, 'a');
  for (size_t i = 0; i < bytes; i += 7) text[i] = char('a' + i % 5);
  return text;
}

std::string incompressible(size_t bytes) {
  std::mt19937 random(1);
  std::string text(bytes, 0);
  for (char& c : text) c = char(random());
  return text;
}

void setSize(std::string& block, int64_t size) {
  std::memcpy(block.data(), &size, 8);
}

/// A file of one grid whose only leaf claims to be stored uncompressed with one byte too many. The
/// same bytes serve any type of four-byte values, compiled into OpenVDB or not.
template <typename GridType>
std::string fileWithWrongLeaf() {
  const auto grid = GridType::create();
  std::mt19937 random(1);
  for (int i = 0; i < 512; ++i)
    grid->tree().setValue(Coord(i >> 6, i >> 3 & 7, i & 7), typename GridType::ValueType(random()));
  std::ostringstream out;
  io::Stream(out).write(openvdb::GridCPtrVec{grid});
  std::string bytes = out.str();
  // The leaf's block is the last thing in the file: a size, then so many bytes.
  for (size_t at = bytes.size() - 2048 - 64; at < bytes.size() - 1000; ++at) {
    int64_t size = 0;
    std::memcpy(&size, &bytes[at], 8);
    if (size != int64_t(bytes.size() - at - 8)) continue;
    size = -2049;
    std::memcpy(&bytes[at], &size, 8);
    return bytes + std::string(4096, 'x');
  }
  FAIL("the block was not found");
  return {};
}

template <typename GridType>
std::string errorOfReadingWrongLeaf() {
  std::istringstream in(fileWithWrongLeaf<GridType>());
  try {
    const io::Stream stream(in, /*delayLoad=*/false);
  } catch (const std::exception& error) {
    return error.what();
  }
  return {};
}

}  // namespace

TEST_CASE("checked_decompression: gives back what was packed", "[checked_decompression]") {
  for (const Codec codec : {Codec::blosc, Codec::zip}) {
    for (const size_t bytes : {1, 4, 15, 16, 17, 100, 2048, 100000}) {
      for (const std::string& text : {compressible(bytes), incompressible(bytes)}) {
        const std::string block = packed(codec, text);
        std::string result(bytes, '?');
        REQUIRE(unpack(codec, block, result.data(), bytes) == int64_t(block.size()));
        REQUIRE(result == text);
        // Without a buffer the block is skipped.
        REQUIRE(unpack(codec, block, nullptr, bytes) == int64_t(block.size()));
      }
    }
  }
}

TEST_CASE("checked_decompression: an empty block is read", "[checked_decompression]") {
  for (const Codec codec : {Codec::blosc, Codec::zip}) {
    const std::string block = packed(codec, {});
    char untouched = '?';
    REQUIRE(unpack(codec, block, &untouched, 0) == int64_t(block.size()));
    REQUIRE(untouched == '?');
  }
}

TEST_CASE("checked_decompression: wrong sizes are refused, the buffer is not overrun",
          "[checked_decompression]") {
  for (const Codec codec : {Codec::blosc, Codec::zip}) {
    for (const std::string& text : {compressible(2048), incompressible(2048)}) {
      const std::string block = packed(codec, text);
      for (const int64_t size :
           {int64_t(-2049), int64_t(-2047), -(int64_t(1) << 62),
            std::numeric_limits<int64_t>::min(), int64_t(0), int64_t(1), int64_t(15),
            int64_t(1) << 40, int64_t(1) << 62, std::numeric_limits<int64_t>::max()}) {
        std::string changed = block;
        setSize(changed, size);
        std::vector<char> exact(2048);  // heap: a sanitizer sees one byte too many
        REQUIRE_THROWS_AS(unpack(codec, changed, exact.data(), exact.size()), std::exception);
      }
      // Another buffer than the block was made for.
      for (const size_t bytes : {2047, 2049, 1, 0}) {
        std::vector<char> other(bytes + 1);
        REQUIRE_THROWS_AS(unpack(codec, block, other.data(), bytes), std::exception);
      }
      for (const size_t length : {size_t(0), size_t(7), size_t(8), block.size() / 2}) {
        std::istringstream stream(block.substr(0, length));
        std::vector<char> exact(2048);
        REQUIRE_THROWS_AS(codec == Codec::blosc
                              ? io::bloscFromStream(stream, exact.data(), exact.size())
                              : io::unzipFromStream(stream, exact.data(), exact.size()),
                          std::exception);
      }
    }
  }
}

TEST_CASE("checked_decompression: damaged blocks are read or refused", "[checked_decompression]") {
  std::mt19937 random(7);
  for (const Codec codec : {Codec::blosc, Codec::zip}) {
    const std::string block = packed(codec, compressible(2048));
    for (int round = 0; round < 5000; ++round) {
      std::string changed = block;
      for (uint32_t i = 0, n = 1 + random() % 3; i < n; ++i)
        changed[random() % changed.size()] = char(random());
      std::vector<char> exact(2048);
      try {
        unpack(codec, changed, exact.data(), exact.size());
      } catch (const std::exception&) {
      }
    }
  }
}

#if OPENVDB_LIBRARY_MAJOR_VERSION_NUMBER < 11
TEST_CASE("checked_decompression: is what OpenVDB calls", "[checked_decompression]") {
  initialize();
  // Float trees are compiled into the library, uint32 trees here.
  if (!UInt32Grid::isRegistered()) UInt32Grid::registerGrid();
  REQUIRE(errorOfReadingWrongLeaf<FloatGrid>().find("checked decompression") != std::string::npos);
  REQUIRE(errorOfReadingWrongLeaf<Int32Grid>().find("checked decompression") != std::string::npos);
  REQUIRE(errorOfReadingWrongLeaf<UInt32Grid>().find("checked decompression") != std::string::npos);
}
#endif
