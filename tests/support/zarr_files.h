// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <blosc.h>

#include <map>
#include <string>

#include "support/images.h"

#include "vdb_madf/images/image.h"

// Zarr version 2 arrays, built by hand from the definition.

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

}  // namespace vdb_madf::test
