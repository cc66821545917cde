// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <array>
#include <cstdint>
#include <cstring>
#include <sstream>
#include <string>
#include <vector>

#include "support/catch.h"
#include "support/glb_files.h"
#include "support/vtk_arrays.h"
#include "vdb_madf/exports/mesh_file.h"

/// Readers of the meshes that are written, by the definitions of the formats.
namespace vdb_madf::test {

using openvdb::Vec3f;

/// A triangle of a file with its grain, where the format has one.
struct Face {
  std::array<Vec3f, 3> corners;
  int32_t grain = 0;
};

template <typename T>
inline T take(const std::string& bytes, size_t& at) {
  T value;
  REQUIRE(at + sizeof value <= bytes.size());
  std::memcpy(&value, bytes.data() + at, sizeof value);
  at += sizeof value;
  return value;
}

inline size_t numberAfter(const std::string& text, const std::string& word) {
  const size_t at = text.find(word);
  REQUIRE(at != std::string::npos);
  return std::stoul(text.substr(at + word.size()));
}

inline std::vector<Face> readPly(const std::string& bytes) {
  const size_t points = numberAfter(bytes, "element vertex "),
               count = numberAfter(bytes, "element face ");
  size_t at = bytes.find("end_header\n") + 11;
  std::vector<Vec3f> positions;
  std::vector<int32_t> grains;
  for (size_t i = 0; i < points; ++i) {
    positions.push_back(take<Vec3f>(bytes, at));
    take<Rgb>(bytes, at);
    grains.push_back(take<int32_t>(bytes, at));
  }
  std::vector<Face> faces(count);
  for (Face& face : faces) {
    REQUIRE(take<uint8_t>(bytes, at) == 3);
    std::array<int32_t, 3> corners;
    for (size_t n = 0; n < 3; ++n) {
      corners[n] = take<int32_t>(bytes, at);
      face.corners[n] = positions.at(size_t(corners[n]));
    }
    take<Rgb>(bytes, at);
    face.grain = take<int32_t>(bytes, at);
    for (const int32_t corner : corners) CHECK(grains[size_t(corner)] == face.grain);
  }
  CHECK(at == bytes.size());
  return faces;
}

inline std::vector<Face> readObj(const std::string& text) {
  std::istringstream lines(text);
  std::vector<Vec3f> positions;
  std::vector<Face> faces;
  int32_t grain = 0;
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    std::string word;
    words >> word;
    if (word == "v") {
      Vec3f p;
      words >> p[0] >> p[1] >> p[2];
      positions.push_back(p);
      float channel = -1;
      for (int c = 0; c < 3; ++c) {
        words >> channel;
        CHECK((channel >= 0 && channel <= 1));
      }
    } else if (word == "g") {
      words >> word;
      REQUIRE(word.substr(0, 6) == "grain_");
      grain = std::stoi(word.substr(6));
    } else if (word == "f") {
      Face face;
      face.grain = grain;
      for (Vec3f& corner : face.corners) {
        size_t number = 0;
        words >> number;
        corner = positions.at(number - 1);
      }
      faces.push_back(face);
    }
  }
  return faces;
}

inline std::vector<Face> readStl(const std::string& bytes) {
  REQUIRE(bytes.substr(0, 5) != "solid");
  size_t at = 80;
  std::vector<Face> faces(take<uint32_t>(bytes, at));
  for (Face& face : faces) {
    const Vec3f normal = take<Vec3f>(bytes, at);
    for (Vec3f& corner : face.corners) corner = take<Vec3f>(bytes, at);
    const Vec3f across =
        (face.corners[1] - face.corners[0]).cross(face.corners[2] - face.corners[0]);
    CHECK(normal.dot(across) == Approx(across.length()));
    take<uint16_t>(bytes, at);
  }
  CHECK(at == bytes.size());
  return faces;
}

inline std::vector<Face> readVtpMesh(const std::string& bytes) {
  const VtkArrays file(bytes);
  const auto points = file.values<Vec3f>("Points");
  const auto corners = file.values<int64_t>("connectivity"), ends = file.values<int64_t>("offsets");
  const auto grains = file.values<int32_t>("grain_id", 1);  // the first is of the points
  REQUIRE(corners.size() == 3 * ends.size());
  REQUIRE(grains.size() == ends.size());
  std::vector<Face> faces(ends.size());
  for (size_t i = 0; i < faces.size(); ++i) {
    CHECK(ends[i] == int64_t(3 * i + 3));
    faces[i].grain = grains[i];
    for (size_t n = 0; n < 3; ++n) faces[i].corners[n] = points.at(size_t(corners[3 * i + n]));
  }
  return faces;
}

/// In the axes of the grid: y of the file is upwards, z is towards the viewer.
inline std::vector<Face> readGlb(const std::string& bytes) {
  std::vector<Face> faces;
  for (const auto& [name, primitive] : Glb(bytes).primitives()) {
    REQUIRE(name.substr(0, 6) == "grain_");
    CHECK(primitive.extras.at("grain_id") == std::stoi(name.substr(6)));
    for (size_t i = 0; i < primitive.indices.size(); i += 3) {
      Face face;
      face.grain = std::stoi(name.substr(6));
      for (size_t n = 0; n < 3; ++n) {
        const auto& p = primitive.points[primitive.indices[i + n]];
        face.corners[n] = Vec3f(p[0], -p[2], p[1]);
      }
      faces.push_back(face);
    }
  }
  return faces;
}

inline std::vector<Face> readMesh(const std::string& ending, const std::string& bytes) {
  return ending == "ply"   ? readPly(bytes)
         : ending == "obj" ? readObj(bytes)
         : ending == "stl" ? readStl(bytes)
         : ending == "glb" ? readGlb(bytes)
                           : readVtpMesh(bytes);
}

}  // namespace vdb_madf::test
