// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <zlib.h>

#include <algorithm>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>

#include "support/catch.h"
#include "support/files.h"
#include "vdb_madf/exports/ome_zarr.h"

// OME-Zarr as another program reads it, by its definition.

namespace vdb_madf::test {

using Json = nlohmann::json;

constexpr OmeVersion kVersions[] = {OmeVersion::v04, OmeVersion::v05, OmeVersion::v06};

inline std::string textOf(OmeVersion version) {
  return version == OmeVersion::v04 ? "0.4" : version == OmeVersion::v05 ? "0.5" : "0.6";
}

inline std::string gunzipped(const std::string& coded, size_t size) {
  std::string bytes(size + 1, '\0');
  z_stream stream{};
  inflateInit2(&stream, 15 + 16);
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(coded.data()));
  stream.avail_in = uInt(coded.size());
  stream.next_out = reinterpret_cast<Bytef*>(bytes.data());
  stream.avail_out = uInt(bytes.size());
  const int result = inflate(&stream, Z_FINISH);
  const size_t made = stream.total_out;
  inflateEnd(&stream);
  if (result != Z_STREAM_END || made != size) throw std::runtime_error("not a chunk");
  bytes.resize(size);
  return bytes;
}

inline Coord fromZyx(const Json& json) {
  REQUIRE(json.size() == 3);
  return {json[2].get<int>(), json[1].get<int>(), json[0].get<int>()};
}

/// An array as a reader of Zarr sees it, by the definition.
struct Array {
  Coord size, chunk;
  size_t sampleBytes = 0, chunkFiles = 0;
  std::map<Coord, uint32_t> values;  ///< that are not 0
  size_t emptyChunkFiles = 0;
};

inline Array readArray(const std::string& path, OmeVersion version) {
  const bool isThree = version != OmeVersion::v04;
  const Json json = Json::parse(readFile(path + (isThree ? "/zarr.json" : "/.zarray")));
  Array array;
  array.size = fromZyx(json.at("shape"));
  const std::string type = json.at(isThree ? "data_type" : "dtype");
  array.sampleBytes = type == "uint32" || type == "<u4" ? 4 : 1;
  CHECK(json.at("zarr_format") == (isThree ? 3 : 2));
  CHECK(json.at("fill_value") == 0);
  if (isThree) {
    CHECK(json.at("node_type") == "array");
    CHECK(type == (array.sampleBytes == 4 ? "uint32" : "uint8"));
    array.chunk = fromZyx(json.at("chunk_grid").at("configuration").at("chunk_shape"));
    CHECK(json.at("codecs").at(0) ==
          Json::parse(R"({"name": "bytes", "configuration": {"endian": "little"}})"));
    CHECK(json.at("codecs").at(1).at("name") == "gzip");
    CHECK(json.at("codecs").size() == 2);
    CHECK(json.at("chunk_key_encoding") ==
          Json::parse(R"({"name": "default", "configuration": {"separator": "/"}})"));
  } else {
    CHECK(type == (array.sampleBytes == 4 ? "<u4" : "|u1"));
    array.chunk = fromZyx(json.at("chunks"));
    CHECK(json.at("compressor").at("id") == "gzip");
    CHECK(json.at("dimension_separator") == "/");
    CHECK(json.at("order") == "C");
    CHECK(json.at("filters").is_null());
  }
  for (int axis = 0; axis < 3; ++axis) CHECK(array.chunk[axis] == std::min(64, array.size[axis]));
  const Coord c = array.chunk;
  const size_t voxels = size_t(c.x()) * size_t(c.y()) * size_t(c.z());
  for (const auto& entry : std::filesystem::recursive_directory_iterator(path)) {
    const std::string name = entry.path().lexically_relative(path).string();
    if (entry.is_directory() || name[0] == '.' || name == "zarr.json") continue;
    int z = 0, y = 0, x = 0;
    REQUIRE(std::sscanf(name.c_str(), isThree ? "c/%d/%d/%d" : "%d/%d/%d", &z, &y, &x) == 3);
    ++array.chunkFiles;
    const std::string bytes =
        gunzipped(readFile(entry.path().string()), voxels * array.sampleBytes);
    size_t place = 0, found = 0;
    for (int k = 0; k < c.z(); ++k)
      for (int j = 0; j < c.y(); ++j)
        for (int i = 0; i < c.x(); ++i, ++place) {
          uint32_t value = 0;
          std::memcpy(&value, &bytes[place * array.sampleBytes], array.sampleBytes);
          if (value == 0) continue;
          ++found;
          array.values[Coord(x * c.x() + i, y * c.y() + j, z * c.z() + k)] = value;
        }
    array.emptyChunkFiles += found == 0;
  }
  return array;
}

inline Json attributesOf(const std::string& path, OmeVersion version) {
  if (version == OmeVersion::v04) {
    CHECK(Json::parse(readFile(path + "/.zgroup")) == Json::parse(R"({"zarr_format": 2})"));
    return Json::parse(readFile(path + "/.zattrs"));
  }
  const Json json = Json::parse(readFile(path + "/zarr.json"));
  CHECK(json.at("zarr_format") == 3);
  CHECK(json.at("node_type") == "group");
  CHECK(json.at("attributes").at("ome").at("version") == textOf(version));
  return json.at("attributes").at("ome");
}

/// The axes of an image, and the scale and the translation of a level of it. Of OME-Zarr 0.6 they
/// belong to its one coordinate system.
struct Place {
  Json axes, scale, translation;
};
inline Place placeOf(const Json& image, size_t level, OmeVersion version) {
  const Json& dataset = image.at("datasets").at(level);
  CHECK(dataset.at("path") == std::to_string(level));
  const Json& given = dataset.at("coordinateTransformations");
  const bool hasSystems = version == OmeVersion::v06;
  CHECK(image.contains("axes") != hasSystems);
  if (hasSystems) {
    REQUIRE(given.size() == 1);
    CHECK(given[0].at("type") == "sequence");
    CHECK(given[0].at("input") == Json::parse("{\"path\": \"" + std::to_string(level) + "\"}"));
    CHECK(given[0].at("output") == Json::parse(R"({"name": "physical"})"));
    REQUIRE(image.at("coordinateSystems").size() == 1);
    CHECK(image["coordinateSystems"][0].at("name") == "physical");
  }
  const Json& steps = hasSystems ? given[0].at("transformations") : given;
  REQUIRE(steps.size() == 2);
  CHECK(steps[0].at("type") == "scale");
  CHECK(steps[1].at("type") == "translation");
  return {(hasSystems ? image["coordinateSystems"][0] : image).at("axes"), steps[0].at("scale"),
          steps[1].at("translation")};
}

}  // namespace vdb_madf::test
