// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <array>
#include <cstring>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "support/catch.h"

/// A reader of glTF 2.0 binary files, by the specification: what it demands of a file is checked.
namespace vdb_madf::test {

struct GlbPrimitive {
  std::vector<std::array<float, 3>> points, normals;  ///< in the world
  std::array<float, 3> pivot;                         ///< of the node
  std::vector<uint32_t> indices;
  std::array<double, 4> color;  ///< linear
  nlohmann::json extras;        ///< of the node
};

class Glb {
 public:
  explicit Glb(const std::string& bytes) : bytes_(bytes) {
    REQUIRE(bytes.substr(0, 4) == "glTF");
    REQUIRE(number<uint32_t>(4) == 2);
    REQUIRE(number<uint32_t>(8) == bytes.size());
    const size_t length = number<uint32_t>(12);
    REQUIRE(bytes.substr(16, 4) == "JSON");
    REQUIRE(length % 4 == 0);
    json_ = nlohmann::json::parse(bytes.substr(20, length));
    REQUIRE(json_.at("asset").at("version") == "2.0");
    if (bytes.size() == 20 + length) return;
    REQUIRE(bytes.substr(24 + length, 4) == std::string("BIN\0", 4));
    binary_ = 28 + length;
    REQUIRE(number<uint32_t>(20 + length) == bytes.size() - binary_);
    REQUIRE(json_.at("buffers").at(0).at("byteLength") == bytes.size() - binary_);
  }

  const nlohmann::json& json() const { return json_; }

  /// The primitives by the names of the nodes of the scene, each a mesh of one primitive of
  /// triangles, at its place.
  std::map<std::string, GlbPrimitive> primitives() const {
    std::map<std::string, GlbPrimitive> result;
    for (const auto& index : json_.at("scenes").at(0).value("nodes", nlohmann::json::array())) {
      const auto& node = json_.at("nodes").at(index.get<size_t>());
      for (const char* moved : {"matrix", "rotation", "scale", "children"})
        CHECK(node.count(moved) == 0);
      const auto& mesh = json_.at("meshes").at(node.at("mesh").get<size_t>());
      REQUIRE(mesh.at("primitives").size() == 1);
      const auto& primitive = mesh.at("primitives").at(0);
      CHECK(primitive.value("mode", 4) == 4);
      GlbPrimitive& made = result[node.at("name")];
      REQUIRE(made.points.empty());
      const auto& attributes = primitive.at("attributes");
      made.points = vectors(attributes.at("POSITION"), true);
      made.pivot = node.at("translation");
      for (auto& point : made.points)
        for (size_t axis = 0; axis < 3; ++axis) point[axis] += made.pivot[axis];
      if (attributes.count("NORMAL")) made.normals = vectors(attributes.at("NORMAL"), false);
      made.indices = indices(primitive.at("indices"), made.points.size());
      const auto& material = json_.at("materials").at(primitive.at("material").get<size_t>());
      made.color = material.at("pbrMetallicRoughness").at("baseColorFactor");
      made.extras = node.at("extras");
    }
    return result;
  }

 private:
  template <typename T>
  T number(size_t at) const {
    T value;
    if (at + sizeof value > bytes_.size()) FAIL("bytes beyond the end");
    std::memcpy(&value, bytes_.data() + at, sizeof value);
    return value;
  }

  /// The places of the items of an accessor in the file.
  std::vector<size_t> places(const nlohmann::json& accessor, size_t itemBytes, size_t numberBytes,
                             int target) const {
    const auto& view = json_.at("bufferViews").at(accessor.at("bufferView").get<size_t>());
    const size_t begin = view.value("byteOffset", size_t(0)), length = view.at("byteLength"),
                 stride = view.value("byteStride", itemBytes),
                 offset = accessor.value("byteOffset", size_t(0)), count = accessor.at("count");
    CHECK(view.at("target") == target);
    CHECK(begin + length <= bytes_.size() - binary_);
    CHECK((begin + offset) % numberBytes == 0);
    CHECK(stride % numberBytes == 0);
    REQUIRE(count > 0);
    REQUIRE(offset + stride * (count - 1) + itemBytes <= length);
    std::vector<size_t> result(count);
    for (size_t i = 0; i < count; ++i) result[i] = binary_ + begin + offset + stride * i;
    return result;
  }

  std::vector<std::array<float, 3>> vectors(const nlohmann::json& index, bool hasRange) const {
    const auto& accessor = json_.at("accessors").at(index.get<size_t>());
    REQUIRE(accessor.at("componentType") == 5126);
    REQUIRE(accessor.at("type") == "VEC3");
    std::vector<std::array<float, 3>> result;
    for (const size_t at : places(accessor, 12, 4, 34962))
      result.push_back({number<float>(at), number<float>(at + 4), number<float>(at + 8)});
    for (size_t axis = 0; hasRange && axis < 3; ++axis) {
      float low = result[0][axis], high = low;
      for (const auto& point : result) {
        low = std::min(low, point[axis]);
        high = std::max(high, point[axis]);
      }
      CHECK(accessor.at("min").at(axis).get<double>() == double(low));
      CHECK(accessor.at("max").at(axis).get<double>() == double(high));
    }
    return result;
  }

  std::vector<uint32_t> indices(const nlohmann::json& index, size_t points) const {
    const auto& accessor = json_.at("accessors").at(index.get<size_t>());
    REQUIRE(accessor.at("type") == "SCALAR");
    const bool isShort = accessor.at("componentType") == 5123;
    if (!isShort) REQUIRE(accessor.at("componentType") == 5125);
    std::vector<uint32_t> result;
    for (const size_t at : places(accessor, isShort ? 2 : 4, isShort ? 2 : 4, 34963)) {
      result.push_back(isShort ? number<uint16_t>(at) : number<uint32_t>(at));
      if (result.back() >= points) FAIL("an index beyond the points");
      if (isShort && result.back() == 0xffff) FAIL("an index that stands for none");
    }
    REQUIRE(result.size() % 3 == 0);
    return result;
  }

  std::string bytes_;
  nlohmann::json json_;
  size_t binary_ = 0;
};

}  // namespace vdb_madf::test
