// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/exports/ome_zarr.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>

#include "support/catch.h"
#include "support/files.h"
#include "support/label_shapes.h"
#include "support/label_slabs.h"
#include "support/ome_zarr_files.h"
#include "support/slab_objects.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/grids/grid_metadata.h"
#include "vdb_madf/labels/grain_colors.h"
#include "vdb_madf/measure/columns.h"

using namespace vdb_madf;
using namespace vdb_madf::test;
namespace fs = std::filesystem;

namespace {

int floorDiv(int a, int b) {
  return int(std::floor(double(a) / b));
}
Coord floorDiv(const Coord& p, int factor) {
  return {floorDiv(p.x(), factor), floorDiv(p.y(), factor), floorDiv(p.z(), factor)};
}

/// What the arrays at 1/factor of a box should hold, counted voxel by voxel.
struct Wanted {
  std::map<Coord, uint32_t> labels, gray;
};
Wanted reduced(const LabelMap& voxels, const CoordBBox& box, int factor) {
  const Coord first = floorDiv(box.min(), factor);
  std::map<Coord, std::map<int32_t, int64_t>> counts;
  for (const auto& [p, label] : voxels) ++counts[floorDiv(p, factor) - first][label];
  std::map<Coord, int64_t> known;
  for (auto p = box.begin(); p; ++p) ++known[floorDiv(*p, factor) - first];
  Wanted wanted;
  for (const auto& [p, labels] : counts) {
    int64_t labeled = 0, most = 0;
    uint32_t label = 0;
    for (const auto& [candidate, count] : labels) {
      labeled += count;
      if (count <= most) continue;
      most = count;
      label = uint32_t(candidate);
    }
    if (most > known[p] - labeled) wanted.labels[p] = label;
    const auto gray = uint32_t(std::floor(255.0 * double(labeled) / double(known[p]) + 0.5));
    if (gray) wanted.gray[p] = gray;
  }
  return wanted;
}

/// The paths of all files in a folder, ascending.
std::vector<std::string> filesBelow(const std::string& folder) {
  std::vector<std::string> files;
  for (const auto& entry : fs::recursive_directory_iterator(folder))
    if (entry.is_regular_file()) files.push_back(fs::relative(entry.path(), folder).string());
  std::sort(files.begin(), files.end());
  return files;
}

const CoordBBox kBox(Coord(-9, -40, 3), Coord(190, 30, 24));

/// Two heaps far from each other, a tile, single voxels in the corners of kBox.
LabelMap heaps() {
  LabelMap voxels = randomLabels(1, Coord(-9, -40, 3), 12, 5, 75);
  for (const auto& one : randomLabels(2, Coord(50, -5, 4), 21, 3, 60)) voxels.insert(one);
  for (int x = 0; x < 8; ++x)
    for (int y = 0; y < 8; ++y)
      for (int z = 0; z < 8; ++z) voxels[{x, y, z + 8}] = 9;
  voxels[kBox.min()] = 123456;
  voxels[kBox.max()] = 2147483647;
  return voxels;
}

Int32Grid::Ptr heapGrid() {
  LabelMap voxels = heaps();
  for (auto voxel = voxels.begin(); voxel != voxels.end();)
    voxel = voxel->second == 9 ? voxels.erase(voxel) : std::next(voxel);
  const auto grid = labelGrid(voxels);
  grid->tree().addTile(1, Coord(0, 0, 8), 9, true);
  grid->tree().setValueOn(Coord(30, 0, 5), -4);  // neither is a label
  grid->tree().setValueOff(Coord(31, 0, 5), 44);
  setDomain(*grid, kBox);
  return grid;
}

}  // namespace

TEST_CASE("ome_zarr: each level holds the most frequent labels, and the object's part",
          "[ome_zarr]") {
  const LabelMap voxels = heaps();
  for (const OmeVersion version : kVersions) {
    const ScratchFolder folder;
    const std::string path = folder / "a.ome.zarr";
    OmeZarrOptions options;
    options.version = version;
    writeOmeZarr(path, *heapGrid(), kBox, options);
    CHECK(folder.fileCount() == 1);
    for (int level = 0; level < 3; ++level) {
      CAPTURE(int(version), level);
      const int factor = 1 << level;
      const std::string name = "/" + std::to_string(level);
      const Array labels = readArray(path + "/labels/grain" + name, version),
                  object = readArray(path + name, version);
      const Wanted wanted = reduced(voxels, kBox, factor);
      const Coord size = floorDiv(kBox.max(), factor) - floorDiv(kBox.min(), factor) + Coord(1);
      CHECK(labels.size == size);
      CHECK(object.size == size);
      CHECK(labels.sampleBytes == 4);
      CHECK(object.sampleBytes == 1);
      CHECK(labels.values == wanted.labels);
      CHECK(object.values == wanted.gray);
      CHECK(labels.emptyChunkFiles + object.emptyChunkFiles == 0);
    }
    CHECK(readArray(path + "/0", version).chunkFiles < 8);  // background is left out
    CHECK_FALSE(fs::exists(path + "/3"));
    CHECK(attributesOf(path + "/labels", version).at("labels") == Json::array({"grain"}));
    if (version == OmeVersion::v06)
      CHECK(attributesOf(path, version).at("multiscales").at(0).at("coordinateTransformations") ==
            Json::parse(R"([{"type": "identity", "input": {"name": "physical"},
                             "output": {"name": "physical", "path": "labels/grain"}}])"));
    CHECK(attributesOf(path + "/labels/grain", version).at("image-label").at("source") ==
          Json::parse(R"({"image": "../../"})"));
  }
}

TEST_CASE("ome_zarr: scale and translation put each voxel where its grid has it", "[ome_zarr]") {
  const ScratchFolder folder;
  const openvdb::Vec3d shift(0.5, -20, 3);  // mm
  for (const OmeVersion version : kVersions)
    for (const std::array<double, 3> edges :
         {std::array<double, 3>{8.5e-6, 8.5e-6, 8.5e-6}, {1e-6, 2e-6, 4.3e-6}, {0, 0, 0}}) {
      const bool hasSize = edges[0] > 0;
      const auto grid = heapGrid();
      if (hasSize) setVoxelSize(*grid, VoxelSize(edges));
      grid->transform().postTranslate(shift);
      const std::string path =
          folder / (std::to_string(int(version)) + std::to_string(edges[2]) + ".zarr");
      fs::remove_all(path);
      OmeZarrOptions options;
      options.version = version;
      writeOmeZarr(path, *grid, kBox, options);
      for (const std::string& group : {path, path + "/labels/grain"}) {
        const Json images = attributesOf(group, version).at("multiscales");
        REQUIRE(images.size() == 1);
        const Json& image = images[0];
        CHECK(image.value("version", "") == (version == OmeVersion::v04 ? "0.4" : ""));
        const Json axes = placeOf(image, 0, version).axes;
        REQUIRE(axes.size() == 3);
        for (size_t i = 0; i < 3; ++i) {
          const Json& axis = axes[i];
          CHECK(axis.at("name") == std::string(1, "zyx"[i]));
          CHECK(axis.at("type") == "space");
          CHECK(axis.value("unit", "") == (hasSize ? "micrometer" : ""));
        }
        REQUIRE(image.at("datasets").size() == 3);
        for (int level = 0; level < 3; ++level) {
          const Place place = placeOf(image, size_t(level), version);
          const int factor = 1 << level;
          const double unit = hasSize ? 1e-3 : 1;  // mm, or voxels
          for (size_t i = 0; i < 3; ++i) {
            const int axis = 2 - int(i), first = floorDiv(kBox.min()[axis], factor);
            const double edge = hasSize ? edges[size_t(axis)] * 1e6 : 1;
            CHECK(place.scale[i].get<double>() == Approx(factor * edge).epsilon(1e-15));
            // The mean place of the fine voxels that the first coarse one stands for.
            const double low = grid->indexToWorld(Coord(factor * first))[axis],
                         high = grid->indexToWorld(Coord(factor * first + factor - 1))[axis];
            CHECK(unit * place.translation[i].get<double>() ==
                  Approx((low + high) / 2).margin(1e-12));
          }
        }
      }
    }
}

TEST_CASE("ome_zarr: a scene holds both images, and says where points of the one lie in the other",
          "[ome_zarr]") {
  const ScratchFolder folder;
  LabelMap voxels = twoBalls(Coord(20), 9);
  for (const auto& one : marker()) voxels.insert(one);
  const auto before = labelGrid(voxels), after = heapGrid();
  setVoxelSize(*before, VoxelSize({1e-6, 2e-6, 4e-6}));
  setVoxelSize(*after, VoxelSize({1e-6, 2e-6, 5e-6}));
  after->transform().postTranslate(openvdb::Vec3d(0.5, -20, 3));
  OmeZarrOptions options;
  options.version = OmeVersion::v06;
  writeOmeZarr(folder / "before.zarr", *before, boxOf(*before), options);
  writeOmeZarr(folder / "after.zarr", *after, boxOf(*after), options);
  const openvdb::Mat3d sheared(1.1, 0.2, 0., -0.1, 0.9, 0.3, 0., 0., 1.),
      one(openvdb::Mat3d::identity());
  const openvdb::Mat3d turned =
      openvdb::math::rotation<openvdb::Mat3d>(openvdb::Vec3d(1, 2, 2).unit(), 0.7);
  const openvdb::Vec3d shift(3, -2.5, 8);
  int number = 0;
  const auto write = [&](const OmeScene& scene) {
    const std::string path = folder / ("scene" + std::to_string(number++));
    writeOmeScene(path, scene);
    return attributesOf(path, OmeVersion::v06).at("scene").at("coordinateTransformations").at(0);
  };
  // What a reader makes of a transformation, of points as z, y, x.
  const auto apply = [](const Json& given, openvdb::Vec3d p) {
    const Json steps =
        given["type"] == "sequence" ? given.at("transformations") : Json::array({given});
    for (const Json& step : steps) {
      const std::string type = step.at("type");
      openvdb::Vec3d moved(0);
      for (int row = 0; row < 3; ++row) {
        if (type == "translation") {
          moved[row] = p[row] + step.at(type).at(size_t(row)).get<double>();
          continue;
        }
        const Json& line = step.at(type).at(size_t(row));
        REQUIRE(line.size() == (type == "affine" ? 4 : 3));
        for (int column = 0; column < 3; ++column)
          moved[row] += line[size_t(column)].get<double>() * p[column];
        if (type == "affine") moved[row] += line[3].get<double>();
      }
      p = moved;
    }
    return p;
  };
  const auto zyx = [](const Int32Grid& grid, const openvdb::Vec3d& voxel) {
    const openvdb::Vec3d world = grid.indexToWorld(voxel) * 1e3;  // mm to um
    return openvdb::Vec3d(world[2], world[1], world[0]);
  };
  for (const auto& [first, linear, type] : {std::tuple{after, one, "translation"},
                                            {before, one, "affine"},
                                            {after, sheared, "affine"}}) {
    const Json given = write({*first, *after, linear, shift});
    CHECK(given.at("type") == type);
    CHECK(given.at("input") == Json::parse(R"({"path": "before", "name": "physical"})"));
    CHECK(given.at("output") == Json::parse(R"({"path": "after", "name": "physical"})"));
    for (const openvdb::Vec3d p : {openvdb::Vec3d(0), openvdb::Vec3d(5, -7, 30)}) {
      const openvdb::Vec3d wanted = zyx(*after, linear * p + shift);
      CHECK((apply(given, zyx(*first, p)) - wanted).length() < 1e-9);
    }
  }
  const auto cubes = labelGrid(voxels);
  setVoxelSize(*cubes, VoxelSize{8.5e-6});
  const Json given = write({*cubes, *cubes, turned, shift});
  CHECK(given.at("transformations").at(0).at("type") == "rotation");
  const openvdb::Vec3d p(5, -7, 30);
  CHECK((apply(given, zyx(*cubes, p)) - zyx(*cubes, turned * p + shift)).length() < 1e-9);

  for (const std::string image : {"before", "after"}) {
    const auto files = filesBelow(folder / (image + ".zarr"));
    CHECK(filesBelow(folder / ("scene1/" + image)) == files);
    for (const std::string& file : files)
      CHECK(readFile(folder / ("scene1/" + image + "/" + file)) ==
            readFile(folder / (image + ".zarr/" + file)));
  }
  CHECK_THROWS_WITH(writeOmeScene(folder / "no", {*before, *labelGrid(voxels)}),
                    vdb_madf::test::Contains("both, or none"));
  CHECK_FALSE(fs::exists(folder / "no"));
}

TEST_CASE("ome_zarr: colors and measures are those of the tables", "[ome_zarr]") {
  const ScratchFolder folder;
  LabelMap voxels = twoBalls(Coord(20), 9);
  for (const auto& one : marker()) voxels.insert(one);
  const auto grid = labelGrid(voxels);
  setVoxelSize(*grid, VoxelSize{8.5e-6});
  const Measurements measured = measure(*grid);
  const GrainColors colors = grainColors(*grid);
  const auto columns = grainColumns(measured.grains);
  for (const OmeVersion version : kVersions) {
    const std::string path = folder / (std::to_string(int(version)) + ".zarr");
    OmeZarrOptions options;
    options.version = version;
    writeOmeZarr(path, *grid, boxOf(*grid), options);
    const Json label = attributesOf(path + "/labels/grain", version).at("image-label");
    CHECK(label.value("version", "") == (version == OmeVersion::v04 ? "0.4" : ""));
    REQUIRE(label.at("colors").size() == colors.labels.size());
    for (size_t i = 0; i < colors.labels.size(); ++i) {
      const Rgb& c = colors.colors[i];
      CHECK(label["colors"][i].at("label-value") == colors.labels[i]);
      CHECK(label["colors"][i].at("rgba") == Json::array({c[0], c[1], c[2], 255}));
    }
    REQUIRE(label.at("properties").size() == measured.grains.size());
    for (size_t i = 0; i < measured.grains.size(); ++i) {
      const Json& one = label["properties"][i];
      CHECK(one.at("label-value") == measured.grains[i].id);
      size_t known = 1;
      for (size_t n = 1; n < columns.size(); ++n) {
        const std::string name = columns[n].name + unitSuffix(columns[n].power, "mm");
        const double value = columns[n].values[i];
        if (std::isnan(value)) {
          CHECK_FALSE(one.contains(name));
          continue;
        }
        ++known;
        CHECK(one.at(name).get<double>() ==
              Approx(scaled(columns[n], value, openvdb::Vec3d(8.5e-3))).epsilon(1e-8));
      }
      CHECK(one.size() == known);
    }
  }
}

TEST_CASE("ome_zarr: labels without a voxel have one chunk, so that none seems lost",
          "[ome_zarr]") {
  const ScratchFolder folder;
  const auto grid = Int32Grid::create(0);
  for (const OmeVersion version : kVersions) {
    const std::string path = folder / (std::to_string(int(version)) + ".zarr");
    OmeZarrOptions options;
    options.version = version;
    writeOmeZarr(path, *grid, CoordBBox(Coord(0), Coord(99, 0, 3)), options);
    for (const std::string name : {"/0", "/1", "/labels/grain/0", "/labels/grain/1"}) {
      const Array array = readArray(path + name, version);
      CHECK(array.chunkFiles == 1);
      CHECK(array.values.empty());
    }
  }
}

TEST_CASE("ome_zarr: labels in slabs give the files of the whole", "[ome_zarr]") {
  const auto requireSame = [](const Int32Grid::Ptr& labels, const CoordBBox& box,
                              const std::vector<int>& cuts, OmeVersion version) {
    const ScratchFolder folder;
    OmeZarrOptions options;
    options.version = version;
    writeOmeZarr(folder / "whole.zarr", *labels, box, options);
    writeOmeZarr(folder / "slabs.zarr", inSlabs(labels, cuts), box, options);
    CHECK(folder.fileCount() == 2);
    const auto files = filesBelow(folder / "whole.zarr");
    REQUIRE(filesBelow(folder / "slabs.zarr") == files);
    for (const std::string& file : files) {
      INFO(file);
      REQUIRE(readFile(folder / ("slabs.zarr/" + file)) ==
              readFile(folder / ("whole.zarr/" + file)));
    }
    return files.size();
  };
  SECTION("wherever they are cut, from thinner than a coarse voxel to one slab") {
    for (int seed = 1; seed <= 4; ++seed) {
      INFO("seed " << seed);
      Rng rng{uint64_t(seed)};
      const Coord low(rng.between(-70, 70), rng.between(-70, 70), rng.between(-300, 300));
      // Levels up to 1/2, 1/4 ... 1/32 of it.
      const Coord size(rng.between(1, 20), rng.between(1, 20), rng.between(65, 700));
      const CoordBBox box(low, low + size.offsetBy(-1));
      const auto labels = Int32Grid::create(0);
      const int grains = rng.between(1, 60), height = rng.between(1, 40);
      for (auto p = box.begin(); p; ++p)
        if (!rng.chance(0.3) && ((*p).z() / 100) % 3 != 1)  // with empty slabs
          labels->tree().setValueOn(
              *p,
              1 + std::abs((*p).x() / 5 + 3 * ((*p).y() / 4) + 7 * ((*p).z() / height)) % grains);
      setDomain(*labels, box);
      requireSame(labels, box, randomCuts(box, rng), kVersions[seed % 3]);
      requireSame(labels, box, {low.z() & ~7, ((box.max().z() | 7) + 1)}, kVersions[seed % 3]);
    }
  }
  SECTION("with the largest factor, 256") {
    const CoordBBox box(Coord(0, 0, -50), Coord(3, 2, 17000));
    const auto labels = Int32Grid::create(0);
    for (auto p = box.begin(); p; ++p)
      if (((*p).z() / 700) % 4) labels->tree().setValueOn(*p, 2 + (*p).z() / 90 + (*p).x() % 2);
    setDomain(*labels, box);
    std::vector<int> cuts{-56};
    while (cuts.back() < 17000) cuts.push_back(cuts.back() + (cuts.size() % 2 ? 8 : 1400));
    CHECK(requireSame(labels, box, cuts, OmeVersion::v05) > 500);
  }
  SECTION("where two labels are equally frequent") {
    const CoordBBox box(Coord(0), Coord(31, 31, 1100));
    const auto labels = Int32Grid::create(0);
    for (auto p = box.begin(); p; ++p)
      labels->tree().setValueOn(*p, ((*p).x() + (*p).z() / 64) % 2 ? 5 : 3 + (*p).z() / 300 * 4);
    setDomain(*labels, box);
    requireSame(labels, box, {0, 8, 40, 264, 800, 808, 1104}, OmeVersion::v04);
  }
  SECTION("labels that leave the box, or have no voxel") {
    const auto labels = heapGrid();
    for (int z = -30; z < 90; ++z) labels->tree().setValueOn(Coord(3, 3, z), 77);
    labels->removeMeta("madf_domain_min");
    labels->removeMeta("madf_domain_max");
    requireSame(labels, kBox, {-32, -8, 8, 16, 24, 96}, OmeVersion::v04);
    requireSame(Int32Grid::create(0), kBox, {-8, 8, 16}, OmeVersion::v04);
  }
}

TEST_CASE("ome_zarr: slabs that cannot be read leave nothing", "[ome_zarr]") {
  const ScratchFolder folder;
  LabelSlabs labels = inSlabs(heapGrid(), {0, 8, 16, 32});
  OmeZarrOptions meshes;
  meshes.meshes = true;
  CHECK_THROWS_WITH(writeOmeZarr(folder / "a.zarr", labels, kBox, meshes),
                    vdb_madf::test::Contains("in one piece"));
  for (int failing : {0, 5, 10, 11}) {  // read by measures, colors and levels
    LabelSlabs broken = labels;
    broken.read = [&](size_t slab, Interrupter* interrupter) {
      if (failing-- == 0) throw IoError("a disk has failed");
      return labels.read(slab, interrupter);
    };
    CHECK_THROWS_WITH(writeOmeZarr(folder / "a.zarr", broken, kBox), "a disk has failed");
  }
  CHECK(folder.fileCount() == 0);
}

TEST_CASE("ome_zarr: what cannot be written leaves nothing", "[ome_zarr]") {
  struct Stop : Interrupter {
    bool wasInterrupted(int) override { return true; }
  } stop;
  const ScratchFolder folder;
  const std::string path = folder / "a.zarr";
  const auto grid = heapGrid();
  CHECK_THROWS_AS(writeOmeZarr(path, *grid, CoordBBox()), InvalidInput);
  CHECK_THROWS_AS(writeOmeZarr(path, *grid, kBox, {}, &stop), Interrupted);
  CHECK_THROWS_AS(writeOmeZarr(folder / "none/a.zarr", *grid, kBox), IoError);
  OmeZarrOptions meshes;
  meshes.meshes = true;
  CHECK_THROWS_WITH(writeOmeZarr(path, *grid, kBox, meshes),
                    vdb_madf::test::Contains("voxel size"));
  grid->transform().postRotate(0.1);
  CHECK_THROWS_WITH(writeOmeZarr(path, *grid, kBox), vdb_madf::test::Contains("resample"));
  CHECK(folder.fileCount() == 0);
  fs::create_directories(path + "/mine");
  CHECK_THROWS_WITH(writeOmeZarr(path, *heapGrid(), kBox), vdb_madf::test::Contains("already"));
  CHECK(fs::exists(path + "/mine"));
}
