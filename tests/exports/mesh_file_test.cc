// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/exports/mesh_file.h"
#include "vdb_madf/labels/grain_name.h"

#include <catch2/catch.hpp>

#include "support/files.h"
#include "support/full_disk.h"
#include "support/label_shapes.h"
#include "support/mesh_files.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/grids/grid_metadata.h"

using namespace vdb_madf;
using namespace vdb_madf::test;
using openvdb::Vec3d;

namespace {

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
  for (const std::string end : {"ply", "obj", "stl", "vtp"}) {
    CAPTURE(end);
    const std::string path = folder / ("mesh." + end);
    writeMesh(path, mesh, optionsOf(*grid));
    const auto faces = readMesh(end, readFile(path));
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

TEST_CASE("mesh_file: a folder of STL appears with all its files or not at all", "[mesh_file]") {
  const ScratchFolder folder;
  LabelMap voxels = twoBalls({0, 0, 0}, 4);
  voxels[{-20, 0, 0}] = 1;  // its file alone is small
  const auto grid = labelGrid(voxels);
  const GrainMesh mesh = grainMesh(*grid);
  const auto refused = [&](const std::string& path) {
    CHECK_THROWS_WITH(writeStlFolder(path, mesh, optionsOf(*grid)), Catch::Contains(path));
    CHECK_THROWS_AS(writeStlFolder(path, mesh, optionsOf(*grid)), IoError);
  };
  {
    const FullDisk disk(1000);
    refused(folder / "grains");
    CHECK(folder.fileCount() == 0);
    std::filesystem::create_directory(folder / "there");
    writeFile(folder / "there/notes", "mine");
    refused(folder / "there");
  }
  CHECK(folder.fileCount() == 1);
  CHECK(std::distance(std::filesystem::directory_iterator(folder / "there"),
                      std::filesystem::directory_iterator()) == 1);
  writeFile(folder / "file", "mine");
  refused(folder / "file");
  refused(folder / "file/below");
  refused(folder / "none/below");
  CHECK(readFile(folder / "file") == "mine");
  writeStlFolder(folder / "there", mesh, optionsOf(*grid));
  CHECK(readStl(readFile(folder / "there/grain_000001.stl")).size() == 12);
  CHECK(readFile(folder / "there/notes") == "mine");
  CHECK(folder.fileCount() == 2);
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
