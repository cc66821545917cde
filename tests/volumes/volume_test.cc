// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/volumes/volume.h"

#include <algorithm>
#include <filesystem>
#include <random>
#include <set>
#include <string>
#include <vector>

#include "support/catch.h"
#include "support/files.h"
#include "support/label_shapes.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/files/file_name.h"
#include "vdb_madf/files/same_file.h"
#include "vdb_madf/grids/grid_metadata.h"
#include "vdb_madf/grids/object_mask.h"
#include "vdb_madf/vdb/slab_folder_writer.h"
#include "vdb_madf/vdb/write_vdb.h"
#include "vdb_madf/volumes/choose_grid.h"
#include "vdb_madf/volumes/load_labels.h"
#include "vdb_madf/volumes/load_object.h"
#include "vdb_madf/volumes/write_image.h"

using namespace vdb_madf;
using namespace vdb_madf::test;
using vdb_madf::test::Contains;
using vdb_madf::test::StartsWith;

namespace {

const CoordBBox kLabelBox(Coord(0), Coord(11, 9, 8));

/// Labels 1 to 5 in a domain, with a voxel size.
Int32Grid::Ptr labelsOfSample() {
  const Int32Grid::Ptr labels = labelGrid(randomLabels(1, Coord(0), 8, 5, 60));
  setDomain(*labels, kLabelBox);
  setVoxelSize(*labels, VoxelSize{1e-5});
  return labels;
}

Int32Grid::Ptr named(const Int32Grid& grid, const std::string& name) {
  const Int32Grid::Ptr copy = grid.deepCopy();
  copy->setName(name);
  return copy;
}

bool sameValues(const Int32Grid& a, const Int32Grid& b) {
  bool same = a.activeVoxelCount() == b.activeVoxelCount();
  for (auto voxel = a.cbeginValueOn(); voxel; ++voxel) {
    int32_t value = 0;
    same &= b.tree().probeValue(voxel.getCoord(), value) && value == *voxel;
  }
  return same;
}

}  // namespace

TEST_CASE("volume: labels and object are the same from every kind of file", "[volume]") {
  const ScratchFolder folder;
  const Int32Grid::Ptr labels = labelsOfSample();
  const MaskGrid::Ptr object = objectMask(*labels),
                      second = objectMask(*labels, Selection::phase(2));
  for (const char* name : {"a.vdb", "a.npy", "a.mha", "a.tif", "a.raw"}) {
    CAPTURE(name);
    const std::string path = folder / name;
    VolumeOptions options;
    if (fileEnding(path) == ".vdb")
      writeVdb(path, {labels});
    else
      writeImage(path, *labels, kLabelBox, SampleType::int32);
    if (fileEnding(path) == ".raw") options.raw = RawLayout{{12, 10, 9}, SampleType::int32};
    options.selection = Selection::threshold(1);  // such labels look like a gray image
    CHECK(isVdbFile(path) == (fileEnding(path) == ".vdb"));
    CHECK(sameValues(*labels, *loadLabels(path, options)));
    const MaskGrid::Ptr found = loadObject(path, options);
    CHECK(found->getName() == "object");
    CHECK(found->tree().hasSameTopology(object->tree()));
    CHECK(storedDomain(*found) == std::optional<CoordBBox>(kLabelBox));
    options.selection = Selection::phase(2);
    CHECK(loadObject(path, options)->activeVoxelCount() == second->activeVoxelCount());
  }
}

TEST_CASE("volume: labels of many small grains are no gray image", "[volume]") {
  const ScratchFolder folder;
  LabelMap grains;
  for (const Coord& p : CoordBBox(Coord(0), Coord(15)))
    if (p.y() % 3 != 2) grains[p] = 1 + p.x() + 16 * (p.y() / 3) + 96 * (p.z() / 2);
  std::vector<int32_t> values;
  for (const auto& voxel : grains) values.push_back(voxel.second);
  LabelMap strewn = grains;
  std::mt19937 random(1);
  std::shuffle(values.begin(), values.end(), random);
  for (auto& voxel : strewn) {
    voxel.second = values.back();
    values.pop_back();
  }
  const std::string labels = folder / "labels.npy", gray = folder / "gray.npy";
  const CoordBBox box(Coord(0), Coord(15));
  writeImage(labels, *labelGrid(grains), box, SampleType::int32);
  writeImage(gray, *labelGrid(strewn), box, SampleType::int32);
  CHECK(sameValues(*labelGrid(grains), *loadLabels(labels)));
  CHECK_THROWS_WITH(loadLabels(gray), Contains("is a gray image, with values from 0 to 768"));

  VolumeOptions options;
  std::string notes;
  options.note = [&](const std::string& text, NoteAbout) { notes += text + "\n"; };
  CHECK(sameValues(*labelGrid(grains), *loadLabels(labels, options)));
  CHECK(notes == "");
  options.areLabels = true;
  CHECK(sameValues(*labelGrid(strewn), *loadLabels(gray, options)));
  CHECK(notes == gray +
                     ": its values, from 0 to 768, are taken for labels, as was said, though they "
                     "lie as in a gray image\n");
  // Runs of two, as a median leaves them, are taken with a note.
  LabelMap smooth;
  for (const Coord& p : CoordBBox(Coord(0), Coord(15)))
    smooth[p] = 1 + strewn[Coord(p.x() & ~1, p.y() / 3 * 3, p.z())] % 150;
  writeImage(gray, *labelGrid(smooth), box, SampleType::int32);
  notes.clear();
  options.areLabels = false;
  loadLabels(gray, options);
  CHECK_THAT(notes, Contains("taken for labels, though they lie as in a gray image, which is"));
}

TEST_CASE("volume: domain and voxel size of the options replace the file's", "[volume]") {
  const ScratchFolder folder;
  const Int32Grid::Ptr labels = labelsOfSample();
  writeVdb(folder / "a.vdb", {labels});
  writeImage(folder / "a.mha", *labels, kLabelBox, SampleType::int32);
  VolumeOptions options;
  options.domain = CoordBBox(Coord(-1), Coord(20));
  options.voxelSize = VoxelSize{3e-6};
  options.selection = Selection::threshold(1);
  for (const char* name : {"a.vdb", "a.mha"}) {
    CAPTURE(name);
    const auto check = [&](const openvdb::GridBase& grid) {
      CHECK(storedDomain(grid) == options.domain);
      REQUIRE(storedVoxelSize(grid));
      CHECK(storedVoxelSize(grid)->edge() == 3e-6);
    };
    check(*loadLabels(folder / name, options));
    check(*loadObject(folder / name, options));
  }
  // An inverted selection is one of the new domain.
  options.selection = Selection{};
  options.selection->invert = true;
  CHECK(int64_t(loadObject(folder / "a.vdb", options)->activeVoxelCount()) ==
        22 * 22 * 22 - int64_t(labels->activeVoxelCount()));
}

TEST_CASE("volume: a voxel size keeps the place, and a domain has to hold the labels", "[volume]") {
  const ScratchFolder folder;
  const Int32Grid::Ptr labels = labelsOfSample();
  labels->transform().preTranslate(openvdb::Vec3d(0.5, 0, -100));  // as of reduced labels
  writeVdb(folder / "a.vdb", {labels});
  VolumeOptions options;
  options.voxelSize = VoxelSize{2e-5};
  options.selection = Selection::threshold(1);
  const openvdb::Vec3d place(0.01, 0, -2);  // mm
  CHECK((loadLabels(folder / "a.vdb", options)->indexToWorld(Coord(0)) - place).length() < 1e-9);
  CHECK((loadObject(folder / "a.vdb", options)->indexToWorld(Coord(0)) - place).length() < 1e-9);
  overrideFile(*labels, "a.vdb", options);
  CHECK((labels->indexToWorld(Coord(0)) - place).length() < 1e-9);

  options.domain = CoordBBox(Coord(0), Coord(3));
  const auto refuses = Contains("a.vdb: the object leaves the domain");
  CHECK_THROWS_WITH(loadLabels(folder / "a.vdb", options), refuses);
  CHECK_THROWS_WITH(overrideFile(*labels, "a.vdb", options), refuses);
  options.region.crop = options.domain;
  CHECK(loadLabels(folder / "a.vdb", options)->activeVoxelCount() > 0);
}

TEST_CASE("volume: the grid is the named one, a usual one or the only one", "[volume]") {
  const ScratchFolder folder;
  const Int32Grid::Ptr labels = labelsOfSample();
  const Int32Grid::Ptr other = named(*labelGrid({{{1, 1, 1}, 4}}), "b");
  writeVdb(folder / "usual.vdb", {other, named(*labels, "truth"), named(*labels, "a")});
  writeVdb(folder / "two.vdb", {named(*labels, "a"), other});
  writeVdb(folder / "mask.vdb", {toBoolGrid(*objectMask(*labels))});
  CHECK(loadLabels(folder / "usual.vdb")->getName() == "truth");
  VolumeOptions options;
  options.grid = "b";
  CHECK(sameValues(*other, *loadLabels(folder / "usual.vdb", options)));
  try {
    loadLabels(folder / "two.vdb");
    FAIL("took one of two");
  } catch (const AmbiguousGrid& error) {
    CHECK(error.grids() == "a (int32), b (int32)");
    CHECK_THAT(error.what(), StartsWith(folder / "two.vdb"));
  }
  CHECK_THROWS_WITH(loadLabels(folder / "mask.vdb"),
                    StartsWith(folder / "mask.vdb") && Contains("no grid of labels"));
  options.grid = "c";
  CHECK_THROWS_WITH(loadObject(folder / "two.vdb", options),
                    Contains("no grid 'c'; the file holds a (int32), b (int32)"));
}

TEST_CASE("volume: options that do not fit the file are refused", "[volume]") {
  const ScratchFolder folder;
  const Int32Grid::Ptr labels = labelsOfSample();
  writeVdb(folder / "a.vdb", {labels});
  writeImage(folder / "a.mhd", *labels, kLabelBox, SampleType::int32);
  VolumeOptions grid, dataset, outputs;
  grid.grid = "grain";
  dataset.dataset = "scan";
  CHECK_THROWS_AS(loadLabels(folder / "a.mhd", grid), InvalidInput);
  CHECK_THROWS_AS(loadLabels(folder / "a.vdb", dataset), InvalidInput);
  // The samples lie beside the header; a link leads to them, too.
  std::filesystem::create_symlink(folder / "a.raw", folder / "link.raw");
  CHECK(isSameFile(folder / "a.raw", folder / "link.raw"));
  CHECK_FALSE(isSameFile(folder / "a.raw", folder / "a.mhd"));
  outputs.outputs = {folder / "link.raw"};
  CHECK_THROWS_WITH(loadObject(folder / "a.mhd", outputs), Contains("would overwrite"));
  outputs.outputs = {folder / "b.raw"};
  outputs.selection = Selection::threshold(1);
  CHECK(loadObject(folder / "a.mhd", outputs)->activeVoxelCount() == labels->activeVoxelCount());
  CHECK_THROWS_AS(loadLabels(folder / "none.vdb"), IoError);
  CHECK_THROWS_AS(loadLabels(folder / "none.tif"), IoError);
}

TEST_CASE("volume: an image that is no file is read as its file is", "[volume]") {
  const ScratchFolder folder;
  const Int32Grid::Ptr labels = labelsOfSample();
  const std::string path = folder / "a.mha";
  writeImage(path, *labels, kLabelBox, SampleType::int32);
  const ImageOpener open = [&] { return openImage(path); };
  VolumeOptions options;
  options.voxelSize = VoxelSize{2e-5};
  std::vector<std::string> notes;
  options.note = [&](const std::string& text, NoteAbout) { notes.push_back(text); };
  const Int32Grid::Ptr same = loadLabels(open, options);
  CHECK(sameValues(*labels, *same));
  CHECK(storedVoxelSize(*same)->edge() == 2e-5);
  REQUIRE(!notes.empty());
  CHECK_THAT(notes[0], StartsWith(path + ": the file says that a voxel is 10 um long"));

  options.selection = Selection::range(2, 4);
  options.region.crop = CoordBBox(Coord(1, 2, 0), Coord(6, 6, 20));
  const MaskGrid::Ptr ofFile = loadObject(path, options), found = loadObject(open, options);
  CHECK(found->tree().hasSameTopology(ofFile->tree()));
  CHECK(storedDomain(*found) == storedDomain(*ofFile));
  CHECK(found->getName() == "object");

  options.region = {};
  options.longestSide = 11;
  CHECK_THROWS_WITH(loadObject(open, options), StartsWith(path + ": is 12 voxels long"));
}

namespace {

/// Writes the voxels of `labels` as a folder of slabs 16 voxels high, up to z = 47.
void writeSlabs(const std::string& path, const Int32Grid& labels) {
  const SlabFolderWriter folder(path, {0, 16, 32, 48});
  for (int s = 0; s < 3; ++s) {
    const Int32Grid::Ptr slab = labels.deepCopy();
    slab->tree().clip(CoordBBox(Coord(0, 0, 16 * s), Coord(100, 100, 16 * s + 15)));
    folder.write(size_t(s), {slab});
  }
  folder.commit();
}

}  // namespace

TEST_CASE("volume: shares are the layers of the whole, each once", "[volume]") {
  const ScratchFolder folder;
  const CoordBBox box(Coord(0), Coord(11, 9, 44));
  const auto labels = Int32Grid::create();
  std::mt19937 random(3);
  for (auto p = box.begin(); p; ++p)
    if (random() % 3 == 0) labels->tree().setValue(*p, 1 + int32_t(random() % 3));
  setDomain(*labels, box);
  writeVdb(folder / "a.vdb", {labels});
  writeSlabs(folder / "a.slabs", *labels);
  for (const char* image : {"a.npy", "a.tif"})
    writeImage(folder / image, *labels, box, SampleType::int32);
  VolumeOptions all, cropped, round, hardlyAny;
  cropped.region.crop = CoordBBox(Coord(2, 0, 5), Coord(11, 8, 33));
  round.region.cylinder = CylinderOptions{2, {}, 4.5};
  hardlyAny.region.crop = CoordBBox(Coord(2, 0, 41), Coord(11, 8, 42));
  for (VolumeOptions options : {all, cropped, round, hardlyAny})
    for (const char* name : {"a.vdb", "a.slabs", "a.npy", "a.tif"}) {
      options.selection = Selection::threshold(2);
      const MaskGrid::Ptr whole = loadObject(folder / name, options);
      for (int parts = 1; parts < 9; ++parts) {
        CAPTURE(name, parts);
        MaskTree joined;
        std::set<int> layers;
        const TakeLayer take = [&](MaskTree& layer) {
          if (layer.empty()) return;
          CHECK(layers.insert(layer.cbeginLeaf()->origin().z()).second);
          joined.topologyUnion(layer);
        };
        for (int part = 0; part < parts; ++part) {
          const MaskGrid::Ptr about = streamObject(folder / name, options, take, {part, parts});
          REQUIRE(storedDomain(*about)->box() == storedDomain(*whole)->box());
          REQUIRE(about->empty());
        }
        REQUIRE(joined.activeVoxelCount() == whole->activeVoxelCount());
        joined.topologyDifference(whole->tree());
        REQUIRE(joined.activeVoxelCount() == 0);
      }
    }
}
