// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/mesh_file.h"

#include <catch2/catch.hpp>
#include <sstream>

#include "support/files.h"
#include "support/label_shapes.h"
#include "vdb_madf/errors.h"
#include "vdb_madf/grid_metadata.h"

using namespace vdb_madf;
using namespace vdb_madf::test;
using openvdb::Vec3d;
using openvdb::Vec3f;

namespace {

/// A triangle of a file with its grain, where the format has one.
struct Face {
  std::array<Vec3f, 3> corners;
  int32_t grain = 0;
};

template <typename T>
T take(const std::string& bytes, size_t& at) {
  T value;
  REQUIRE(at + sizeof value <= bytes.size());
  std::memcpy(&value, bytes.data() + at, sizeof value);
  at += sizeof value;
  return value;
}

size_t numberAfter(const std::string& text, const std::string& word) {
  const size_t at = text.find(word);
  REQUIRE(at != std::string::npos);
  return std::stoul(text.substr(at + word.size()));
}

std::vector<Face> readPly(const std::string& bytes) {
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

std::vector<Face> readObj(const std::string& text) {
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

std::vector<Face> readStl(const std::string& bytes) {
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

/// Signed volume of each grain in a file.
std::map<int32_t, double> fileVolumes(const std::vector<Face>& faces) {
  std::map<int32_t, double> result;
  for (const Face& face : faces)
    result[face.grain] +=
        Vec3d(face.corners[0]).dot(Vec3d(face.corners[1]).cross(Vec3d(face.corners[2]))) / 6;
  return result;
}

openvdb::BBoxd boxOf(const std::vector<Face>& faces) {
  openvdb::BBoxd box;
  for (const Face& face : faces)
    for (const Vec3f& corner : face.corners) box.expand(Vec3d(corner));
  return box;
}

MeshFileOptions optionsOf(const Int32Grid& grid) {
  MeshFileOptions options;
  options.transform = grid.constTransformPtr();
  options.lengthUnit = "mm";
  options.colors = grainColors(grid);
  return options;
}

}  // namespace

TEST_CASE("mesh_file: every format has every triangle at its place in the world", "[mesh_file]") {
  const ScratchFolder folder;
  const LabelMap voxels = twoBalls({40, -7, 3}, 5);
  const auto grid = labelGrid(voxels);
  constexpr double kEdge = 0.5;
  setVoxelSize(*grid, VoxelSize{kEdge * 1e-3});
  const GrainMesh mesh = grainMesh(*grid);
  const auto volume = volumes(voxels);
  for (const std::string end : {"ply", "obj", "stl"}) {
    CAPTURE(end);
    const std::string path = folder / ("mesh." + end);
    writeMesh(path, mesh, optionsOf(*grid));
    const std::string bytes = readFile(path);
    const auto faces = end == "ply"   ? readPly(bytes)
                       : end == "obj" ? readObj(bytes)
                                      : readStl(bytes);
    CHECK(faces.size() == mesh.triangles.size());
    const auto found = fileVolumes(faces);
    const double cube = kEdge * kEdge * kEdge;
    if (end == "stl") {
      REQUIRE(found.size() == 1);
      CHECK(found.at(0) == Approx(double(voxels.size()) * cube));
    } else {
      REQUIRE(found.size() == 2);
      for (const auto& [label, count] : volume)
        CHECK(found.at(label) == Approx(double(count) * cube));
    }
    // The world position of a voxel is its centre, so its faces are half a voxel away.
    const CoordBBox box = grid->evalActiveVoxelBoundingBox();
    CHECK(boxOf(faces).min() == kEdge * (box.min().asVec3d() - Vec3d(0.5)));
    CHECK(boxOf(faces).max() == kEdge * (box.max().asVec3d() + Vec3d(0.5)));
  }
}

TEST_CASE("mesh_file: one STL per grain", "[mesh_file]") {
  const ScratchFolder folder;
  const LabelMap voxels = twoBalls({0, 0, 0}, 4);
  const auto grid = labelGrid(voxels);
  writeStlFolder(folder / "grains", grainMesh(*grid), optionsOf(*grid));
  for (const auto& [label, count] : volumes(voxels)) {
    const auto faces = readStl(readFile(folder / ("grains/" + grainName(label) + ".stl")));
    CHECK(fileVolumes(faces).at(0) == Approx(double(count)));
  }
  CHECK(grainName(123) == "grain_000123");
}

TEST_CASE("mesh_file: a mirrored world keeps the outside outside", "[mesh_file]") {
  const ScratchFolder folder;
  const auto grid = labelGrid({{Coord(1, 2, 3), 1}});
  const auto transform = openvdb::math::Transform::createLinearTransform(2.0);
  transform->preScale(Vec3d(1, 1, -1));
  grid->setTransform(transform);
  writeMesh(folder / "m.stl", grainMesh(*grid), optionsOf(*grid));
  CHECK(fileVolumes(readStl(readFile(folder / "m.stl"))).at(0) == Approx(8));
}

TEST_CASE("mesh_file: nothing to write, and endings nobody knows", "[mesh_file]") {
  const ScratchFolder folder;
  const auto grid = labelGrid({});
  const GrainMesh mesh = grainMesh(*grid);
  for (const std::string end : {"ply", "obj", "stl", "vtp"})
    writeMesh(folder / ("m." + end), mesh, optionsOf(*grid));
  CHECK(readPly(readFile(folder / "m.ply")).empty());
  CHECK(readStl(readFile(folder / "m.stl")).empty());
  CHECK_THROWS_AS(writeMesh(folder / "m.abc", mesh, optionsOf(*grid)), InvalidInput);
  CHECK_THROWS_AS(writeMesh(folder / "no/m.ply", mesh, optionsOf(*grid)), IoError);
  CHECK(folder.fileCount() == 4);
  CHECK(isMeshEnding("a.PLY"));
  CHECK(!isMeshEnding("a.vdb"));
}
