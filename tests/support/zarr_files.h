// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <blosc.h>
#include <zstd.h>

#include <cstring>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "support/files.h"
#include "support/images.h"
#include "vdb_madf/images/image.h"

// Zarr arrays of versions 2 and 3, built by hand from the definitions.

namespace vdb_madf::test {

struct ZarrLayout {
  ImageSize size, chunk;
  std::string type = "|u1";
  size_t bytes = 1;   ///< of a sample
  std::string codec;  ///< "", "zlib", "gzip", "blosc", or one of blosc's: "zstd", "lz4hc" ...
  std::string order = "C";
  std::string separator = ".";
  std::string fill = "0";
  int leading = 0;  ///< axes of length 1
};

inline std::string bloscOf(const std::string& bytes, size_t typeSize, const std::string& codec) {
  std::string out(bytes.size() + BLOSC_MAX_OVERHEAD, '\0');
  const int size = blosc_compress_ctx(5, BLOSC_SHUFFLE, typeSize, bytes.size(), bytes.data(),
                                      out.data(), out.size(), codec.c_str(), 0, 1);
  out.resize(size_t(size));
  return out;
}

inline std::string zarrDescription(const ZarrLayout& layout) {
  const auto shape = [&](const ImageSize& c) {
    std::string text = "[";
    for (int i = 0; i < layout.leading; ++i) text += "1, ";
    return text + std::to_string(c.z) + ", " + std::to_string(c.y) + ", " + std::to_string(c.x) +
           "]";
  };
  const std::string compressor = layout.codec.empty() ? "null"
                                 : layout.codec == "zlib" || layout.codec == "gzip"
                                     ? "{\"id\": \"" + layout.codec + "\", \"level\": 1}"
                                     : "{\"id\": \"blosc\", \"cname\": \"lz4\"}";
  return "{\"chunks\": " + shape(layout.chunk) + ", \"compressor\": " + compressor +
         ", \"dtype\": \"" + layout.type + "\", \"fill_value\": " + layout.fill +
         ", \"filters\": null, \"order\": \"" + layout.order +
         "\", \"shape\": " + shape(layout.size) +
         ", \"zarr_format\": 2, \"dimension_separator\": \"" + layout.separator + "\"}";
}

/// The files of an array, by path within its folder. `samples`: x fastest.
inline std::map<std::string, std::string> zarrFiles(const ZarrLayout& layout,
                                                    const std::string& samples) {
  std::map<std::string, std::string> files;
  files[".zarray"] = zarrDescription(layout);
  const ImageSize &n = layout.size, &c = layout.chunk;
  const size_t size = layout.bytes;
  for (int k = 0; k * c.z < n.z; ++k)
    for (int j = 0; j * c.y < n.y; ++j)
      for (int i = 0; i * c.x < n.x; ++i) {
        std::string chunk(voxels(c) * size, '\x6b');
        for (int z = 0; z < c.z; ++z)
          for (int y = 0; y < c.y; ++y)
            for (int x = 0; x < c.x; ++x) {
              const ImageSize p{i * c.x + x, j * c.y + y, k * c.z + z};
              if (p.x >= n.x || p.y >= n.y || p.z >= n.z) continue;
              const size_t to = layout.order == "C" ? size_t((z * c.y + y) * c.x + x)
                                                    : size_t((x * c.y + y) * c.z + z);
              const size_t from = size_t((p.z * n.y + p.y) * n.x + p.x);
              chunk.replace(to * size, size, samples, from * size, size);
            }
        if (layout.codec == "zlib" || layout.codec == "gzip")
          chunk = deflated(chunk, layout.codec == "zlib" ? 15 : 31);
        else if (!layout.codec.empty())
          chunk = bloscOf(chunk, size, layout.codec == "blosc" ? "lz4" : layout.codec);
        std::string key;
        for (int l = 0; l < layout.leading; ++l) key += "0" + layout.separator;
        key += std::to_string(k) + layout.separator + std::to_string(j) + layout.separator +
               std::to_string(i);
        files[key] = chunk;
      }
  return files;
}

/// Bit by bit.
inline uint32_t crc32cOf(const std::string& bytes) {
  uint32_t sum = 0xffffffff;
  for (const char byte : bytes)
    for (int bit = 0; bit < 8; ++bit) {
      const bool isOdd = (sum ^ (static_cast<unsigned char>(byte) >> bit)) & 1;
      sum = (sum >> 1) ^ (isOdd ? 0x82f63b78 : 0);
    }
  return ~sum;
}
inline std::string withSum(const std::string& bytes) {
  const uint32_t sum = crc32cOf(bytes);
  return bytes + std::string(reinterpret_cast<const char*>(&sum), 4);
}
inline std::string zstdOf(const std::string& bytes) {
  std::string out(ZSTD_compressBound(bytes.size()), '\0');
  out.resize(ZSTD_compress(out.data(), out.size(), bytes.data(), bytes.size(), 3));
  return out;
}

struct Zarr3Layout {
  ImageSize size, chunk;
  ImageSize shard{};  ///< 0: none
  std::string type = "uint8";
  size_t bytes = 1;                   ///< of a sample, little-endian if not said otherwise
  std::vector<std::string> codecs{};  ///< after "bytes": gzip, zstd, blosc, crc32c
  std::vector<std::string> indexCodecs{"crc32c"};
  std::string order{};  ///< of transpose: "zyx" is none; stored slowest first
  std::string keys = "default", separator = "/";
  std::string fill = "0";
  bool bigEndian = false;  ///< the samples are given so; of a shard's index, too
  bool indexAtStart = false;
  int leading = 0;  ///< axes of length 1
  std::string attributes = "{}";
};

inline std::string zarr3Codecs(const Zarr3Layout& layout, const std::vector<std::string>& codecs,
                               bool isIndex) {
  std::string text = "[";
  if (!isIndex && !layout.order.empty()) {
    text += R"({"name": "transpose", "configuration": {"order": [)";
    for (int i = 0; i < layout.leading; ++i) text += std::to_string(i) + ", ";
    for (int i = 0; i < 3; ++i)
      text +=
          (i ? ", " : "") +
          std::to_string(layout.leading + int(std::string("zyx").find(layout.order[size_t(i)])));
    text += "]}}, ";
  }
  text += std::string(R"({"name": "bytes", "configuration": {"endian": ")") +
          (layout.bigEndian ? "big" : "little") + "\"}}";
  for (const std::string& codec : codecs)
    text += ", {\"name\": \"" + codec + "\"" +
            (codec == "gzip" ? ", \"configuration\": {\"level\": 1}" : "") + "}";
  return text + "]";
}

inline std::string zarr3Description(const Zarr3Layout& layout) {
  const auto shape = [&](const ImageSize& c) {
    std::string text = "[";
    for (int i = 0; i < layout.leading; ++i) text += "1, ";
    return text + std::to_string(c.z) + ", " + std::to_string(c.y) + ", " + std::to_string(c.x) +
           "]";
  };
  const bool isSharded = layout.shard.x > 0;
  const std::string inner = zarr3Codecs(layout, layout.codecs, false);
  const std::string sharding =
      R"([{"name": "sharding_indexed", "configuration": {"chunk_shape": )" + shape(layout.chunk) +
      ", \"codecs\": " + inner +
      ", \"index_codecs\": " + zarr3Codecs(layout, layout.indexCodecs, true) +
      ", \"index_location\": \"" + (layout.indexAtStart ? "start" : "end") + "\"}}]";
  return R"({"zarr_format": 3, "node_type": "array", "shape": )" + shape(layout.size) +
         ", \"data_type\": \"" + layout.type +
         R"(", "chunk_grid": {"name": "regular", "configuration": {"chunk_shape": )" +
         shape(isSharded ? layout.shard : layout.chunk) +
         R"(}}, "chunk_key_encoding": {"name": ")" + layout.keys +
         R"(", "configuration": {"separator": ")" + layout.separator + R"("}}, "fill_value": )" +
         layout.fill + ", \"codecs\": " + (isSharded ? sharding : inner) +
         ", \"attributes\": " + layout.attributes + "}";
}

/// The bytes of a chunk at (i, j, k) of the grid of chunks.
inline std::string zarr3Chunk(const Zarr3Layout& layout, const std::string& samples, int i, int j,
                              int k) {
  const ImageSize &n = layout.size, &c = layout.chunk;
  const std::string order = layout.order.empty() ? "zyx" : layout.order;
  std::string chunk;
  int p[3];  // the voxel, by the letters of x, y, z
  const auto lengthOf = [&](char axis) { return c[axis - 'x']; };
  for (p[order[0] - 'x'] = 0; p[order[0] - 'x'] < lengthOf(order[0]); ++p[order[0] - 'x'])
    for (p[order[1] - 'x'] = 0; p[order[1] - 'x'] < lengthOf(order[1]); ++p[order[1] - 'x'])
      for (p[order[2] - 'x'] = 0; p[order[2] - 'x'] < lengthOf(order[2]); ++p[order[2] - 'x']) {
        const ImageSize at{i * c.x + p[0], j * c.y + p[1], k * c.z + p[2]};
        const size_t from = size_t((at.z * n.y + at.y) * n.x + at.x);
        chunk += at.x < n.x && at.y < n.y && at.z < n.z
                     ? samples.substr(from * layout.bytes, layout.bytes)
                     : std::string(layout.bytes, '\x6b');
      }
  for (const std::string& codec : layout.codecs)
    chunk = codec == "gzip"     ? deflated(chunk, 31)
            : codec == "zstd"   ? zstdOf(chunk)
            : codec == "crc32c" ? withSum(chunk)
                                : bloscOf(chunk, layout.bytes, "lz4");
  return chunk;
}

inline void appendNumber(std::string& text, uint64_t number, bool bigEndian) {
  std::string bytes(reinterpret_cast<const char*>(&number), 8);
  text += bigEndian ? std::string(bytes.rbegin(), bytes.rend()) : bytes;
}

/// The bytes of a shard; chunks of zeros alone are left out.
inline std::string zarr3Shard(const Zarr3Layout& layout, const std::string& samples, int i, int j,
                              int k) {
  const ImageSize per{layout.shard.x / layout.chunk.x, layout.shard.y / layout.chunk.y,
                      layout.shard.z / layout.chunk.z};
  const size_t sums = layout.indexCodecs.size();
  const size_t indexBytes = 16 * voxels(per) + 4 * sums;
  std::string data, index;
  for (int z = 0; z < per.z; ++z)
    for (int y = 0; y < per.y; ++y)
      for (int x = 0; x < per.x; ++x) {
        Zarr3Layout bare = layout;
        bare.codecs.clear();
        const int a = i * per.x + x, b = j * per.y + y, c = k * per.z + z;
        const std::string plain = zarr3Chunk(bare, samples, a, b, c);
        const bool isEmpty = plain.find_first_not_of(std::string("\0\x6b", 2)) == std::string::npos;
        const std::string chunk = isEmpty ? "" : zarr3Chunk(layout, samples, a, b, c);
        appendNumber(index,
                     isEmpty ? ~uint64_t(0) : data.size() + (layout.indexAtStart ? indexBytes : 0),
                     layout.bigEndian);
        appendNumber(index, isEmpty ? ~uint64_t(0) : chunk.size(), layout.bigEndian);
        data += chunk;
      }
  for (size_t s = 0; s < sums; ++s) index = withSum(index);
  return layout.indexAtStart ? index + data : data + index;
}

/// The files of an array, by path within its folder. `samples`: x fastest.
inline std::map<std::string, std::string> zarr3Files(const Zarr3Layout& layout,
                                                     const std::string& samples) {
  std::map<std::string, std::string> files;
  files["zarr.json"] = zarr3Description(layout);
  const bool isSharded = layout.shard.x > 0;
  const ImageSize &n = layout.size, &c = isSharded ? layout.shard : layout.chunk;
  for (int k = 0; k * c.z < n.z; ++k)
    for (int j = 0; j * c.y < n.y; ++j)
      for (int i = 0; i * c.x < n.x; ++i) {
        std::string key = layout.keys == "default" ? "c" + layout.separator : "";
        for (int l = 0; l < layout.leading; ++l) key += "0" + layout.separator;
        key += std::to_string(k) + layout.separator + std::to_string(j) + layout.separator +
               std::to_string(i);
        files[key] =
            isSharded ? zarr3Shard(layout, samples, i, j, k) : zarr3Chunk(layout, samples, i, j, k);
      }
  return files;
}

inline const ImageSize kZarrSize{11, 7, 9}, kZarrChunk{4, 3, 5};

inline Zarr3Layout zarr3Layout(SampleType type) {
  Zarr3Layout layout{kZarrSize, kZarrChunk};
  layout.type = sampleTypeName(type);
  layout.bytes = sampleSize(type);
  return layout;
}

/// In the place of what was there.
inline void writeZarr(const std::string& path, const std::map<std::string, std::string>& files) {
  std::filesystem::remove_all(path);
  for (const auto& [name, bytes] : files) {
    std::filesystem::create_directories(std::filesystem::path(path + "/" + name).parent_path());
    writeFile(path + "/" + name, bytes);
  }
}

}  // namespace vdb_madf::test
