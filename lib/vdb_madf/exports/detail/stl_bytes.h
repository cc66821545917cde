// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <openvdb/Types.h>

#include <array>
#include <cstdint>
#include <cstring>
#include <string>

namespace vdb_madf::detail {

/// What a binary STL begins with, before its triangles.
inline std::string stlHead(const std::string& unit, uint32_t triangles) {
  std::string head = "vdb_madf grains; lengths in " + unit;  // not "solid": that is text
  head.resize(80, ' ');
  return head.append(reinterpret_cast<const char*>(&triangles), sizeof triangles);
}

/// Counterclockwise seen from outside.
inline std::array<char, 50> stlTriangle(const openvdb::Vec3f& a, const openvdb::Vec3f& b,
                                        const openvdb::Vec3f& c) {
  using openvdb::Vec3d;
  using openvdb::Vec3f;
  const Vec3d normal = Vec3d(b - a).cross(Vec3d(c - a));
  const double length = normal.length();
  std::array<char, 50> bytes{};
  size_t at = 0;
  for (const Vec3f& value : {length > 0 ? Vec3f(normal / length) : Vec3f(0), a, b, c}) {
    std::memcpy(&bytes[at], value.asPointer(), 12);
    at += 12;
  }
  return bytes;
}

}  // namespace vdb_madf::detail
