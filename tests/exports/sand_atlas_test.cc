// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/exports/sand_atlas.h"

#include <array>
#include <atomic>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <sstream>

#include "support/catch.h"
#include "support/files.h"
#include "support/full_disk.h"
#include "support/label_shapes.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/grids/grid_metadata.h"
#include "vdb_madf/measure/measure.h"
#include "vdb_madf/vdb/read_vdb.h"

using namespace vdb_madf;
using namespace vdb_madf::test;
namespace fs = std::filesystem;

namespace {

/// Two balls that touch, 3 and 7, a leaf of one voxel's thickness, 40, a shell, 41, which no facets
/// of a third of it could show, and at a face one voxel, 5.
LabelMap sample() {
  LabelMap voxels = twoBalls(Coord(20, 14, 12), 8);
  for (const Coord& p : CoordBBox(Coord(4, 30, 3), Coord(24, 30, 22))) voxels[p] = 40;
  const Coord center(60, 20, 15);
  for (const Coord& p : CoordBBox(center - Coord(12), center + Coord(12))) {
    const double distance = (p - center).asVec3d().length();
    if (distance > 10 && distance < 12) voxels[p] = 41;
  }
  voxels[Coord(0, 35, 3)] = 5;
  return voxels;
}

Int32Grid::Ptr sampleGrid() {
  const auto grid = labelGrid(sample());
  setVoxelSize(*grid, VoxelSize(1e-5));
  setDomain(*grid, CoordBBox(Coord(0), Coord(79, 39, 29)));
  return grid;
}

struct Body {
  openvdb::BBoxd box;
  double volume = 0;
  openvdb::Vec3d moment{0, 0, 0};
};

Body bodyOf(const std::string& stl) {
  uint32_t triangles = 0;
  std::memcpy(&triangles, &stl.at(80), sizeof triangles);
  REQUIRE(stl.size() == 84 + 50 * size_t(triangles));
  Body body;
  for (size_t i = 0; i < triangles; ++i) {
    std::array<openvdb::Vec3f, 3> corners;
    std::memcpy(corners.data(), &stl[84 + 50 * i + 12], sizeof corners);
    const openvdb::Vec3d a(corners[0]), b(corners[1]), c(corners[2]);
    const double volume = a.dot(b.cross(c)) / 6;
    for (const openvdb::Vec3d& corner : {a, b, c}) body.box.expand(corner);
    body.volume += volume;
    body.moment += volume * (a + b + c) / 4;
  }
  return body;
}

}  // namespace

TEST_CASE("sand_atlas: grains away from the faces, whole, by number", "[sand_atlas]") {
  const ScratchFolder folder;
  const std::string path = folder / "sand-1";
  const auto grid = sampleGrid();
  const SandAtlasCounts counts = writeSandAtlas(path, *grid);
  CHECK(counts.particles == 4);
  CHECK(counts.atFaces == 1);
  const std::vector<int32_t> labels{3, 7, 40, 41};
  const LabelMap voxels = sample();
  const auto sizes = volumes(voxels);
  for (size_t i = 0; i < labels.size(); ++i) {
    const std::string name = "/particle_0000" + std::to_string(i + 1);
    const auto grids = readVdb(path + "/vdb" + name + ".vdb");
    REQUIRE(grids.size() == 1);
    CHECK(grids[0]->getName() == "density");
    CHECK(grids[0]->getGridClass() == openvdb::GRID_FOG_VOLUME);
    CHECK(grids[0]->voxelSize() == openvdb::Vec3d(1));
    const auto density = openvdb::gridPtrCast<FloatGrid>(grids[0]);
    CHECK(density->background() == 0);
    CoordBBox box;
    for (const auto& [p, label] : voxels)
      if (label == labels[i]) box.expand(p);
    size_t found = 0;
    for (auto voxel = density->cbeginValueOn(); voxel; ++voxel) {
      const auto at = voxels.find(voxel.getCoord() + box.min() - Coord(1));
      found += *voxel == 1 && at != voxels.end() && at->second == labels[i];
    }
    CHECK(density->activeVoxelCount() == size_t(sizes.at(labels[i])));
    CHECK(found == density->activeVoxelCount());
    CHECK(density->evalActiveVoxelBoundingBox() == CoordBBox(Coord(1), box.dim()));
    for (const std::string quality : {"ORIGINAL", "100", "30", "10", "3"}) {
      CAPTURE(name, quality);
      const Body body = bodyOf(readFile(path + "/stl_" + quality + name + ".stl"));
      CHECK(body.volume == Approx(1e-6 * double(sizes.at(labels[i]))).epsilon(1e-4));
      CHECK((body.moment / body.volume).length() < 1e-5);
      for (int axis = 0; axis < 3; ++axis)
        CHECK(body.box.extents()[axis] > 0.006 * box.dim()[axis]);  // no part is lost
    }
  }
  CHECK_FALSE(fs::exists(path + "/vdb/particle_00005.vdb"));
  CHECK_THROWS_AS(writeSandAtlas(path, *grid), IoError);  // nothing is replaced
}

TEST_CASE("sand_atlas: the table has the measures, the JSON what is known", "[sand_atlas]") {
  const ScratchFolder folder;
  const auto grid = sampleGrid();
  writeSandAtlas(folder / "sand-1/", *grid, 0);
  std::istringstream table(readFile(folder / "sand-1/sand-1.csv"));
  std::string line;
  std::getline(table, line);
  CHECK(line ==
        "Particle ID,Volume (µm³),Equivalent Diameter (µm),Major Axis Length (µm),Middle Axis "
        "Length (µm),Minor Axis Length (µm),True Sphericity (-),Convexity (-),Flatness (-),"
        "Elongation (-),Compactness (-)");
  MeasureOptions options;
  options.shape = true;
  const auto grains = measure(*grid, options).grains;
  double particle = 0;
  for (const GrainMeasures& grain : grains) {
    if (grain.id == 5) continue;
    const auto& axes = grain.ellipsoid.values;
    double number = 0;
    char comma = 0;
    table >> number;
    CHECK(number == ++particle);
    for (const double wanted :
         {1000 * grain.volume, 10 * grain.equivalentDiameter, 10 * axes[0], 10 * axes[1],
          10 * axes[2], *grain.sphericity, grain.solidity(), axes[2] / axes[1], axes[1] / axes[0],
          std::pow(*grain.sphericity, 3)}) {
      table >> comma >> number;
      CHECK(number == Approx(wanted).epsilon(1e-8));
    }
  }
  CHECK_FALSE(table >> line);
  const std::string about = readFile(folder / "sand-1/sand-1.json");
  CHECK(about.find("\"title\": \"sand-1\"") != std::string::npos);
  CHECK(about.find("\"lat_lon\": null") != std::string::npos);
  CHECK(about.find("\"number_of_particles\": 4,") != std::string::npos);
  CHECK(about.find("\"microns_per_pixel\": 10.0\n") != std::string::npos);
}

TEST_CASE("sand_atlas: without a size, of boxes, or of cut grains alone there is none",
          "[sand_atlas]") {
  const ScratchFolder folder;
  const std::string path = folder / "sand";
  CHECK_THROWS_AS(writeSandAtlas(path, *labelGrid(sample())), InvalidInput);
  const auto boxes = labelGrid(sample());
  setVoxelSize(*boxes, VoxelSize({1e-5, 1e-5, 2e-5}));
  CHECK_THROWS_AS(writeSandAtlas(path, *boxes), InvalidInput);
  const auto cut = labelGrid({{Coord(0), 1}});
  setVoxelSize(*cut, VoxelSize(1e-5));
  CHECK_THROWS_AS(writeSandAtlas(path, *cut), InvalidInput);
  CHECK(fs::is_empty(folder / ""));
}

TEST_CASE("sand_atlas: interrupted anywhere, or on a full disk, it leaves nothing",
          "[sand_atlas]") {
  struct Stop : Interrupter {
    explicit Stop(int last) : left(last) {}
    bool wasInterrupted(int) override { return --left < 0; }
    std::atomic<int> left;
  };
  const ScratchFolder folder;
  const auto grid = sampleGrid();
  int polls = 0;
  for (;; ++polls) {
    Stop stop(polls);
    try {
      writeSandAtlas(folder / "sand", *grid, 10, &stop);
      break;
    } catch (const Interrupted&) {
      REQUIRE(folder.fileCount() == 0);
    }
  }
  CHECK(polls > 4);  // each grain asks
  for (const rlim_t bytes : {4000, 100000}) {
    const FullDisk disk(bytes);
    CHECK_THROWS_AS(writeSandAtlas(folder / "more", *grid), IoError);
  }
  CHECK(folder.fileCount() == 1);
}
