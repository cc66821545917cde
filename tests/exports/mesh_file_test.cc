// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/exports/mesh_file.h"
#include "vdb_madf/labels/grain_name.h"

#include "support/catch.h"
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
  for (const std::string end : {"ply", "obj", "stl", "vtp", "glb"}) {
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
    // The world position of a voxel is its center, so its faces are half a voxel away.
    const CoordBBox box = grid->evalActiveVoxelBoundingBox();
    CHECK(boxOf(faces).min() == kEdge * (box.min().asVec3d() - Vec3d(0.5)));
    CHECK(boxOf(faces).max() == kEdge * (box.max().asVec3d() + Vec3d(0.5)));
  }
}

TEST_CASE("mesh_file: an OBJ has materials of the colors of its grains", "[mesh_file]") {
  const ScratchFolder folder;
  const auto grid = labelGrid(twoBalls({0, 0, 0}, 4));
  const MeshFileOptions options = optionsOf(*grid);
  writeMesh(folder / "a b.obj", grainMesh(*grid), options);
  std::map<std::string, std::array<double, 3>> colors;  // by material
  std::istringstream materials(readFile(folder / "a b.mtl"));
  for (std::string word, name; materials >> word;)
    if (word == "newmtl") {
      materials >> name;
    } else {
      REQUIRE(word == "Kd");
      for (double& channel : colors[name]) materials >> channel;
    }
  REQUIRE(colors.size() == 2);
  const std::string text = readFile(folder / "a b.obj");
  CHECK_THAT(text, vdb_madf::test::Contains("\nmtllib a b.mtl\n"));
  std::istringstream words(text);
  int32_t label = 0;
  int used = 0;
  for (std::string word; words >> word;) {
    if (word.substr(0, 6) == "grain_") label = std::stoi(word.substr(6));
    if (word != "usemtl") continue;
    words >> word;
    const Rgb color = options.colors.colorOf(label);
    for (size_t i = 0; i < 3; ++i) CHECK(colors.at(word)[i] == Approx(color[i] / 255.0));
    ++used;
  }
  CHECK(used == 2);
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

TEST_CASE("mesh_file: voxels that touch along an edge are apart in every format", "[mesh_file]") {
  const ScratchFolder folder;
  const auto grid = labelGrid({{Coord(0, 0, 0), 1}, {Coord(1, 1, 0), 1}});
  const GrainMesh mesh = grainMesh(*grid);
  for (const std::string end : {"ply", "obj", "stl", "vtp", "glb"}) {
    CAPTURE(end);
    const std::string path = folder / ("mesh." + end);
    writeMesh(path, mesh, optionsOf(*grid));
    std::map<std::pair<Vec3f, Vec3f>, int> edges;
    for (const Face& face : readMesh(end, readFile(path)))
      for (size_t n = 0; n < 3; ++n)
        ++edges[std::minmax(face.corners[n], face.corners[(n + 1) % 3])];
    for (const auto& edge : edges) CHECK(edge.second == 2);
  }
}

TEST_CASE("mesh_file: a folder of STL appears with all its files or not at all", "[mesh_file]") {
  const ScratchFolder folder;
  LabelMap voxels = twoBalls({0, 0, 0}, 4);
  voxels[{-20, 0, 0}] = 1;  // its file alone is small
  const auto grid = labelGrid(voxels);
  const GrainMesh mesh = grainMesh(*grid);
  const auto refused = [&](const std::string& path) {
    CHECK_THROWS_WITH(writeStlFolder(path, mesh, optionsOf(*grid)), vdb_madf::test::Contains(path));
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
  writeMesh(folder / "m.glb", grainMesh(*grid), optionsOf(*grid));
  CHECK(fileVolumes(readGlb(readFile(folder / "m.glb"))).at(1) == Approx(8));
}

TEST_CASE("mesh_file: of a smoothed mesh the GLB has the triangles of the PLY", "[mesh_file]") {
  const ScratchFolder folder;
  const auto grid = labelGrid(randomLabels(5, {-3, 7, -11}, 12, 30, 60));
  setVoxelSize(*grid, VoxelSize{8.5e-6});
  const GrainMesh mesh = grainMesh(*grid, {3});
  MeshFileOptions options = optionsOf(*grid);
  options.shadeSmooth = GENERATE(false, true);
  for (const std::string end : {"ply", "glb"}) writeMesh(folder / ("m." + end), mesh, options);
  const auto ply = readPly(readFile(folder / "m.ply")), glb = readGlb(readFile(folder / "m.glb"));
  REQUIRE(glb.size() == ply.size());
  for (size_t i = 0; i < ply.size(); ++i) {
    REQUIRE(glb[i].grain == ply[i].grain);
    for (size_t n = 0; n < 3; ++n)  // from the pivots: rounded once more
      REQUIRE((glb[i].corners[n] - ply[i].corners[n]).length() < 1e-7f);
  }
}

TEST_CASE("mesh_file: a grain's node in a GLB has its color and its measures", "[mesh_file]") {
  const ScratchFolder folder;
  const auto grid = labelGrid(twoBalls({40, -7, 3}, 5));
  setVoxelSize(*grid, VoxelSize{8.5e-6});
  const GrainNetwork measured = grainNetwork(*grid);
  MeshFileOptions options = optionsOf(*grid);
  options.measured = &measured;
  writeMesh(folder / "m.glb", grainMesh(*grid), options);
  const Glb file(readFile(folder / "m.glb"));
  CHECK(file.json()["scenes"][0]["extras"]["length_unit"] == "mm");
  const auto grains = file.primitives();
  REQUIRE(grains.size() == measured.grains.size());
  for (size_t i = 0; i < grains.size(); ++i) {
    const GlbPrimitive& grain = grains.at(grainName(measured.grains[i]));
    for (size_t c = 0; c < 3; ++c)
      CHECK(grain.color[c] == Approx(linearChannel(measured.colors[i][c])));
    CHECK(grain.color[3] == 1);
    size_t known = 0;
    for (const GrainNetwork::Column& column : measured.grainColumns) {
      CAPTURE(column.name);
      const double value = column.values[i];
      CHECK(grain.extras.count(column.name) == !std::isnan(value));
      if (std::isnan(value)) continue;
      ++known;
      CHECK(grain.extras[column.name].get<double>() == value);
      CHECK(grain.extras[column.name].is_number_integer() == column.isCount);
    }
    CHECK(grain.extras.size() == known + 1);
    const Vec3f pivot(grain.pivot[0], -grain.pivot[2], grain.pivot[1]);
    for (int k = 0; k < 3; ++k) {
      const double centroid = grain.extras[std::string("centroid_") + "xyz"[k]];
      CHECK(std::abs(pivot[k] - centroid) < 0.1 * 8.5e-3);
    }
    CHECK(grain.extras["voxels"] == measured.grainColumns[0].values[i]);
    CHECK(grain.extras["equivalent_diameter"].get<double>() > 0.05);
  }
}

TEST_CASE("mesh_file: normals of a GLB point outwards, and have the length 1", "[mesh_file]") {
  const ScratchFolder folder;
  LabelMap ball;
  for (const auto& [p, label] : twoBalls({0, 0, 0}, 9))
    if (p.asVec3d().lengthSqr() < 81) ball[p] = 1;
  const auto grid = labelGrid(ball);
  MeshFileOptions options = optionsOf(*grid);
  options.shadeSmooth = true;
  writeMesh(folder / "m.glb", grainMesh(*grid, {10}), options);
  const auto grains = Glb(readFile(folder / "m.glb")).primitives();
  const GlbPrimitive& grain = grains.at("grain_000001");
  REQUIRE(grain.normals.size() == grain.points.size());
  for (size_t i = 0; i < grain.points.size(); ++i) {
    const Vec3f normal(grain.normals[i].data()), point(grain.points[i].data());
    REQUIRE(normal.length() == Approx(1));
    REQUIRE(normal.dot(point.unit()) > 0.9);
  }
}

TEST_CASE("mesh_file: a grain of more than 16 bits of points", "[mesh_file]") {
  const ScratchFolder folder;
  GrainMesh mesh;  // fans, one for each side of the largest index of 16 bits
  mesh.labels = {1, 2};
  for (const uint32_t count : {65535u, 65536u}) {
    const uint32_t first = mesh.firstPoint.back();
    for (uint32_t i = 0; i < count; ++i) mesh.points.push_back(Vec3f(float(i), float(i % 7), 0));
    for (uint32_t i = first; i + 2 < first + count; i += 2)
      mesh.triangles.push_back({first, i + 1, i + 2});
    mesh.firstPoint.push_back(uint32_t(mesh.points.size()));
    mesh.firstTriangle.push_back(uint32_t(mesh.triangles.size()));
  }
  writeMesh(folder / "m.glb", mesh, {});
  const Glb file(readFile(folder / "m.glb"));
  CHECK(file.json()["accessors"][1]["componentType"] == 5123);
  CHECK(file.json()["accessors"][3]["componentType"] == 5125);
  size_t triangle = 0;
  for (const auto& [name, grain] : file.primitives())
    for (size_t i = 0; i < grain.indices.size(); i += 3, ++triangle)
      for (size_t n = 0; n < 3; ++n) {
        const auto& point = grain.points[grain.indices[i + n]];
        const Vec3f expected = mesh.points[mesh.triangles[triangle][n]];
        REQUIRE((Vec3f(point[0], -point[2], point[1]) - expected).length() < 0.01f);
      }
  CHECK(triangle == mesh.triangles.size());
}

TEST_CASE("mesh_file: a GLB of more than 4 GiB is refused before it is meshed", "[mesh_file]") {
  MeshFileOptions options;
  // 12 bytes a triangle, 18 with normals
  CHECK_NOTHROW(checkMeshRoom("m.glb", 357900000, options));
  CHECK_THROWS_WITH(checkMeshRoom("m.glb", 358000000, options),
                    "m.glb: a .glb holds 4 GiB, and the mesh takes 5: ask for fewer triangles, or "
                    "write .ply");
  CHECK_NOTHROW(checkMeshRoom("m.ply", 358000000, options));
  options.shadeSmooth = true;
  CHECK_NOTHROW(checkMeshRoom("m.glb", 238600000, options));
  CHECK_THROWS_AS(checkMeshRoom("m.GLB", 238700000, options), InvalidInput);
}

TEST_CASE("mesh_file: materials of another file are not replaced", "[mesh_file]") {
  const ScratchFolder folder;
  const auto grid = labelGrid(twoBalls({0, 0, 0}, 4));
  std::ofstream(folder / "m.mtl") << "mine";
  CHECK_THROWS_AS(writeMesh(folder / "m.obj", grainMesh(*grid), optionsOf(*grid)), IoError);
  CHECK(readFile(folder / "m.mtl") == "mine");
  CHECK(folder.fileCount() == 1);
}

TEST_CASE("mesh_file: nothing to write, and endings nobody knows", "[mesh_file]") {
  const ScratchFolder folder;
  const auto grid = labelGrid({});
  const GrainMesh mesh = grainMesh(*grid);
  for (const std::string end : {"ply", "obj", "stl", "vtp", "glb"})
    writeMesh(folder / ("m." + end), mesh, optionsOf(*grid));
  CHECK(readPly(readFile(folder / "m.ply")).empty());
  CHECK(readStl(readFile(folder / "m.stl")).empty());
  CHECK(readGlb(readFile(folder / "m.glb")).empty());
  CHECK_THROWS_AS(writeMesh(folder / "m.abc", mesh, optionsOf(*grid)), InvalidInput);
  CHECK_THROWS_AS(writeMesh(folder / "no/m.ply", mesh, optionsOf(*grid)), IoError);
  // Also the materials of the .obj.
  CHECK(folder.fileCount() == 6);
  CHECK(worldUnit(*grid).empty());  // voxels
  setProportions(*grid, {0.01, 0.01, 0.01});
  CHECK(worldUnit(*grid) == "an unknown unit");
  setVoxelSize(*grid, VoxelSize(1e-5));
  CHECK(worldUnit(*grid) == "mm");
  CHECK(isMeshEnding("a.PLY"));
  CHECK(!isMeshEnding("a.vdb"));
}
