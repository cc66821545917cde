// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/scans/scan_region.h"

#include <random>

#include "support/catch.h"
#include "support/files.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/grids/grid_metadata.h"
#include "vdb_madf/grids/object_mask.h"
#include "vdb_madf/vdb/write_vdb.h"
#include "vdb_madf/volumes/dense_volume.h"
#include "vdb_madf/volumes/load_labels.h"
#include "vdb_madf/volumes/load_object.h"
#include "vdb_madf/volumes/write_image.h"

using namespace vdb_madf;
using namespace vdb_madf::test;
using vdb_madf::test::Contains;

namespace {

const CoordBBox kScanBox(Coord(0), Coord(40, 36, 20));

/// Values of a gray scan with a round field of view: outside 9, inside 100 to 119, or 200 to 219.
std::vector<uint8_t> roundScan(double radius, uint8_t outside = 9, double centerX = 20,
                               double centerY = 18) {
  std::mt19937 random(1);
  std::vector<uint8_t> samples;
  for (int z = 0; z <= kScanBox.max().z(); ++z)
    for (int y = 0; y <= kScanBox.max().y(); ++y)
      for (int x = 0; x <= kScanBox.max().x(); ++x) {
        const double dx = x - centerX, dy = y - centerY;
        const auto value = uint8_t(100 + random() % 20 + 100 * (random() % 3 == 0));
        samples.push_back(dx * dx + dy * dy <= radius * radius ? value : outside);
      }
  return samples;
}

void writeScan(const std::string& path, const std::vector<uint8_t>& samples) {
  const CoordBBox box = kScanBox;
  const auto grid = Int32Grid::create();
  size_t i = 0;
  for (int z = 0; z <= box.max().z(); ++z)
    for (int y = 0; y <= box.max().y(); ++y)
      for (int x = 0; x <= box.max().x(); ++x) grid->tree().setValue({x, y, z}, samples[i++]);
  writeImage(path, *grid, box, SampleType::uint8);
}

/// The note about what was fitted, and the error.
struct Loaded {
  MaskGrid::Ptr object;
  std::string notes, error;
};

Loaded load(const std::string& path, VolumeOptions options) {
  Loaded loaded;
  options.note = [&](const std::string& text, NoteAbout) { loaded.notes += text + "\n"; };
  try {
    loaded.object = loadObject(path, options);
  } catch (const InvalidInput& error) {
    loaded.error = error.what();
    CHECK_THAT(loaded.error, vdb_madf::test::StartsWith(path) || Contains(options.region.mask));
  }
  return loaded;
}

VolumeOptions above(double threshold) {
  VolumeOptions options;
  options.selection = Selection::threshold(threshold);
  return options;
}

}  // namespace

TEST_CASE("scan_region: a cylinder holds the voxels whose centers are within the radius",
          "[scan_region]") {
  const CoordBBox boxes[] = {kScanBox, {Coord(-130, -9, -3), Coord(150, 140, 139)}};
  for (const CoordBBox& box : boxes)
    for (int axis = 0; axis < 3; ++axis)
      for (const double radius : {3.0, 14.5, 90.0}) {
        CAPTURE(box, axis, radius);
        const Cylinder cylinder{axis, {12.5, 7}, radius};
        const Domain domain = cylinderIn(box, cylinder);
        const int u = axis == 0 ? 1 : 0, v = axis == 2 ? 1 : 2;
        int64_t inside = 0, wrong = 0;
        for (auto p = box.begin(); p != box.end(); ++p) {
          const double du = (*p)[u] - 12.5, dv = (*p)[v] - 7;
          const bool isIn = du * du + dv * dv <= radius * radius;
          inside += isIn;
          wrong += isIn != domain.isInside(*p);
        }
        CHECK(wrong == 0);
        CHECK(domain.voxelCount() == inside);
        CHECK(box.isInside(domain.box()));
      }
  CHECK(cylinderIn(kScanBox, {2, {20, 18}, 100}) == Domain(kScanBox));
  CHECK_THROWS_AS(cylinderIn(kScanBox, {2, {90, 18}, 10}), InvalidInput);
  CHECK(largestRadius(kScanBox, 2, {20, 18}) == 18.5);
  CHECK(largestRadius(kScanBox, 0, {18, 8}) == 8.5);
}

TEST_CASE("scan_region: a large cylinder takes little memory", "[scan_region]") {
  const CoordBBox box(Coord(0), Coord(1999));
  const Domain domain = cylinderIn(box, {2, {999.5, 999.5}, 1000});
  CHECK(double(domain.voxelCount()) == Approx(M_PI * 1e6 * 2000).epsilon(1e-4));
  CHECK(domain.region()->memUsage() < (size_t(64) << 20));
}

TEST_CASE("scan_region: the cylinder is fitted to what is not 0 or a value around it",
          "[scan_region]") {
  const ScratchFolder folder;
  for (const uint8_t outside : {uint8_t(0), uint8_t(9)}) {
    CAPTURE(int(outside));
    writeScan(folder / "a.npy", roundScan(15, outside));
    VolumeOptions options = above(200);
    options.region.cylinder = CylinderOptions{};
    const Loaded loaded = load(folder / "a.npy", options);
    REQUIRE(loaded.object);
    CHECK(storedDomain(*loaded.object) == cylinderIn(kScanBox, {2, {20, 18}, 15}));
    CHECK_THAT(loaded.notes,
               Contains("along z around x 20, y 18, which with a radius of 15 voxels"));
    // Of a VDB, the object.
    const MaskGrid::Ptr all = loadObject(folder / "a.npy", above(100));
    writeVdb(folder / "a.vdb", {toBoolGrid(*all)});
    VolumeOptions ofGrid;
    ofGrid.region = options.region;
    const Loaded second = load(folder / "a.vdb", ofGrid);
    REQUIRE(second.object);
    CHECK(storedDomain(*second.object) == storedDomain(*loaded.object));
  }
  // Where all is scanned, the largest that lies in the box.
  writeScan(folder / "b.npy", roundScan(100));
  VolumeOptions options = above(200);
  options.region.cylinder = CylinderOptions{};
  CHECK(storedDomain(*load(folder / "b.npy", options).object) ==
        cylinderIn(kScanBox, {2, {20, 18}, 18.5}));
  options.region.cylinder->axis = 0;
  CHECK(storedDomain(*load(folder / "b.npy", options).object) ==
        cylinderIn(kScanBox, {0, {18, 10}, 10.5}));
  options.region.cylinder->center = {{90, 0}};
  CHECK_THAT(load(folder / "b.npy", options).error, Contains("give one"));
  writeScan(folder / "b.npy", std::vector<uint8_t>(kScanBox.volume(), 7));
  options.region.cylinder = CylinderOptions{};
  CHECK_THAT(load(folder / "b.npy", options).error, Contains("field of view"));
}

TEST_CASE("scan_region: the center of a gray scan's field of view is fitted, too",
          "[scan_region]") {
  const ScratchFolder folder;
  const std::vector<uint8_t> samples = roundScan(14, 0, 17.3, 19.6);
  writeScan(folder / "a.npy", samples);
  VolumeOptions options = above(200);
  options.region.cylinder = CylinderOptions{};
  const Loaded loaded = load(folder / "a.npy", options);
  REQUIRE(loaded.object);
  const auto domain = storedDomain(*loaded.object);
  int64_t scanned = 0, inside = 0;
  size_t i = 0;
  for (int z = 0; z <= kScanBox.max().z(); ++z)
    for (int y = 0; y <= kScanBox.max().y(); ++y)
      for (int x = 0; x <= kScanBox.max().x(); ++x) {
        const bool isScanned = samples[i++] != 0;
        scanned += isScanned;
        inside += isScanned && domain->isInside(Coord(x, y, z));
      }
  CHECK(inside == scanned);
  CHECK(int64_t(domain->voxelCount()) == scanned);
  CHECK_THAT(loaded.notes, Contains("voxels were fitted"));
  // Of a mask nothing tells the field of view from pores, so the middle of the box counts.
  std::vector<uint8_t> mask;
  for (const uint8_t value : samples) mask.push_back(value >= 200);
  writeScan(folder / "b.npy", mask);
  VolumeOptions ofMask;
  ofMask.region = options.region;
  CHECK_THAT(load(folder / "b.npy", ofMask).notes, Contains("around x 20, y 18, to which"));
  // Of a scan that was cut on one side the circle goes on behind it.
  writeScan(folder / "c.npy", roundScan(16, 0, 12, 18));
  const auto cut = storedDomain(*load(folder / "c.npy", options).object);
  CHECK(cut->box().min().x() == 0);
  CHECK(cut->isInside(Coord(0, 18, 0)));
  CHECK(!cut->isInside(Coord(0, 3, 0)));
}

TEST_CASE("scan_region: thresholds see the region alone", "[scan_region]") {
  const ScratchFolder folder;
  writeScan(folder / "a.npy", roundScan(15));
  VolumeOptions options;
  options.gray.automatic = AutomaticThreshold::otsu;
  CHECK_THROWS_AS(loadObject(folder / "a.npy", options), SelectionNeeded);  // 9 is at all corners
  options.region.cylinder = CylinderOptions{};
  const Loaded loaded = load(folder / "a.npy", options);
  REQUIRE(loaded.object);
  VolumeOptions plain = above(200);
  plain.region = options.region;
  CHECK(loaded.object->tree().hasSameTopology(load(folder / "a.npy", plain).object->tree()));
  CHECK_THAT(loaded.notes, !Contains("left out"));
}

TEST_CASE("scan_region: object outside is left out, which is said, and nothing else changes",
          "[scan_region]") {
  const ScratchFolder folder;
  writeScan(folder / "a.npy", roundScan(100));
  const MaskGrid::Ptr whole = loadObject(folder / "a.npy", above(200));
  writeVdb(folder / "a.vdb", {toBoolGrid(*whole)});
  const Domain core = cylinderIn(kScanBox, {2, {20, 18}, 12.5});
  for (const bool invert : {false, true})
    for (const char* name : {"a.npy", "a.vdb"}) {
      CAPTURE(name, invert);
      VolumeOptions options = above(std::string(name) == "a.npy" ? 200 : 1);
      options.selection->invert = invert;
      options.region.cylinder = CylinderOptions{2, {}, 12.5};
      const Loaded loaded = load(folder / name, options);
      REQUIRE(loaded.object);
      int64_t wrong = 0, outside = 0;
      for (auto p = kScanBox.begin(); p != kScanBox.end(); ++p) {
        const bool selected = whole->tree().isValueOn(*p) != invert;
        wrong += (selected && core.isInside(*p)) != loaded.object->tree().isValueOn(*p);
        outside += selected && !core.isInside(*p);
      }
      CHECK(wrong == 0);
      CHECK(storedDomain(*loaded.object) == core);
      const std::string text = std::to_string(outside) + " object voxels left out";
      CHECK((loaded.notes.find(text) != std::string::npos) == !invert);
    }
}

TEST_CASE("scan_region: a crop is the cropped array at its old place", "[scan_region]") {
  const ScratchFolder folder;
  const std::vector<uint8_t> samples = roundScan(100);
  writeScan(folder / "a.npy", samples);
  const CoordBBox crop(Coord(3, 5, 6), Coord(30, 28, 19));
  std::vector<uint8_t> part;
  for (int z = crop.min().z(); z <= crop.max().z(); ++z)
    for (int y = crop.min().y(); y <= crop.max().y(); ++y)
      for (int x = crop.min().x(); x <= crop.max().x(); ++x)
        part.push_back(samples[size_t((z * kScanBox.dim().y() + y) * kScanBox.dim().x() + x)]);
  DenseLayout layout;
  layout.box = crop;
  const auto wanted = maskFromDense(part.data(), layout, Selection::threshold(200));
  VolumeOptions options = above(200);
  options.region.crop = crop;
  for (const int automatic : {0, 1}) {
    if (automatic) options.gray.automatic = AutomaticThreshold::otsu;
    const Loaded loaded = load(folder / "a.npy", options);
    REQUIRE(loaded.object);
    CHECK(loaded.object->tree().hasSameTopology(wanted->tree()));
    CHECK(storedDomain(*loaded.object) == Domain(crop));
    CHECK(loaded.notes == "");
  }
  // Beyond the scan there is nothing.
  options.region.crop = CoordBBox(Coord(30), Coord(99));
  CHECK_THAT(load(folder / "a.npy", options).error, Contains("no voxel"));
  options.region.crop = CoordBBox(Coord(30, 30, -5), Coord(99, 99, 5));
  CHECK(storedDomain(*load(folder / "a.npy", options).object) ==
        Domain(CoordBBox(Coord(30, 30, 0), Coord(40, 36, 5))));
  // With a region both hold.
  options.region.crop = crop;
  options.region.cylinder = CylinderOptions{2, {}, 12.5};
  CHECK(storedDomain(*load(folder / "a.npy", options).object) ==
        cylinderIn(kScanBox, {2, {20, 18}, 12.5}).within(crop));
}

TEST_CASE("scan_region: the region in a file is no object of it", "[scan_region]") {
  const ScratchFolder folder;
  const auto phases = Int32Grid::create();
  phases->setName("phases");
  phases->tree().setValue(Coord(20, 18, 3), 2);
  setDomain(*phases, cylinderIn(kScanBox, {2, {20, 18}, 12.5}));
  writeVdb(folder / "a.vdb", {phases});
  CHECK(loadObject(folder / "a.vdb")->activeVoxelCount() == 1);
  CHECK(loadLabels(folder / "a.vdb")->getName() == "phases");
  VolumeOptions options;
  options.grid = "region";
  CHECK(loadObject(folder / "a.vdb", options)->activeVoxelCount() ==
        uint64_t(storedDomain(*phases)->voxelCount()));
  // It is inverted within it.
  options = above(1);
  options.selection->invert = true;
  CHECK(loadObject(folder / "a.vdb", options)->activeVoxelCount() ==
        uint64_t(storedDomain(*phases)->voxelCount()) - 1);
}

TEST_CASE("scan_region: a mask of any kind is a region", "[scan_region]") {
  const ScratchFolder folder;
  writeScan(folder / "a.npy", roundScan(100));
  writeScan(folder / "labels.npy", roundScan(12.5, 0));  // many values: what is not 0
  const Domain core = cylinderIn(kScanBox, {2, {20, 18}, 12.5});
  const auto mask = MaskGrid::create(std::make_shared<MaskTree>(*core.region()));
  mask->setName("object");
  writeVdb(folder / "mask.vdb", {toBoolGrid(*mask)});
  setDomain(*mask, kScanBox);
  writeVdb(folder / "known.vdb", {toBoolGrid(*mask)});
  VolumeOptions options = above(200);
  for (const char* name : {"labels.npy", "mask.vdb", "known.vdb"}) {
    CAPTURE(name);
    options.region.mask = folder / name;
    const Loaded loaded = load(folder / "a.npy", options);
    REQUIRE(loaded.object);
    CHECK(storedDomain(*loaded.object) == core);
  }
  const auto second = toBoolGrid(*mask);
  mask->setName("other");
  second->setName("second");
  writeVdb(folder / "two.vdb", {toBoolGrid(*mask), second});
  options.region.mask = folder / "two.vdb";
  CHECK_THAT(load(folder / "a.npy", options).error,
             vdb_madf::test::StartsWith(folder / "two.vdb") && Contains("several grids"));
  // The whole box is no region.
  writeScan(folder / "full.npy", std::vector<uint8_t>(kScanBox.volume(), 1));
  options.region.mask = folder / "full.npy";
  CHECK(storedDomain(*load(folder / "a.npy", options).object) == Domain(kScanBox));
  writeScan(folder / "zero.npy", std::vector<uint8_t>(kScanBox.volume(), 0));
  options.region.mask = folder / "zero.npy";
  CHECK_THAT(load(folder / "a.npy", options).error, Contains("all is 0"));
  // One of another scan, too small or too large.
  writeImage(folder / "small.npy", *mask, CoordBBox(Coord(0), Coord(39, 36, 20)),
             SampleType::uint8);
  options.region.mask = folder / "small.npy";
  CHECK_THAT(load(folder / "a.npy", options).error,
             Contains("40x37x21") && Contains("41x37x21") && Contains("does not cover"));
  writeImage(folder / "large.npy", *mask, CoordBBox(Coord(0), Coord(60, 36, 20)),
             SampleType::uint8);
  options.region.mask = folder / "large.npy";
  const Loaded loaded = load(folder / "a.npy", options);
  REQUIRE(loaded.object);
  CHECK(storedDomain(*loaded.object) == core);
  CHECK_THAT(loaded.notes, Contains("is larger than"));
}

TEST_CASE("scan_region: labels are cut to it, be they an image or a grid", "[scan_region]") {
  const ScratchFolder folder;
  writeScan(folder / "view.npy", roundScan(15, 0));
  const auto all = Int32Grid::create(0);
  all->setName("grain");
  for (auto p = kScanBox.begin(); p; ++p)
    if ((*p).x() % 5 > 0) all->tree().setValue(*p, 1 + (*p).x() / 5 + (*p).z() / 12);
  all->tree().addTile(1, Coord(16, 16, 8), 77, true);
  setDomain(*all, kScanBox);
  writeVdb(folder / "l.vdb", {all});
  writeImage(folder / "l.npy", *all, kScanBox, SampleType::int32);
  VolumeOptions options;
  options.region.mask = folder / "view.npy";
  options.region.crop = CoordBBox(Coord(3, 0, 2), Coord(30, 99, 17));
  const Domain domain = cylinderIn({Coord(3, 0, 2), Coord(30, 36, 17)}, {2, {20, 18}, 15});
  for (const std::string file : {"l.vdb", "l.npy"}) {
    CAPTURE(file);
    std::string notes;
    options.note = [&](const std::string& text, NoteAbout) { notes += text; };
    const Int32Grid::Ptr labels = loadLabels(folder / file, options);
    CHECK(storedDomain(*labels) == domain);
    int64_t wrong = 0, inside = 0, leftOut = 0;
    for (auto p = kScanBox.begin(); p; ++p) {
      const int32_t label = domain.isInside(*p) ? all->tree().getValue(*p) : 0;
      wrong += labels->tree().getValue(*p) != label || labels->tree().isValueOn(*p) != (label > 0);
      inside += label > 0;
      leftOut += label == 0 && options.region.crop->isInside(*p) && all->tree().isValueOn(*p);
    }
    CHECK(wrong == 0);
    CHECK(int64_t(labels->activeVoxelCount()) == inside);
    CHECK_THAT(notes, Contains(file + ": outside of the region, " + std::to_string(leftOut) +
                               " labeled voxels left out"));
  }
  options.note = nullptr;
  options.region.mask = folder / "missing.npy";
  CHECK_THROWS_WITH(loadLabels(folder / "l.npy", options), Contains("missing.npy"));
  options.region = {};
  options.region.crop = CoordBBox(Coord(90), Coord(99));
  CHECK_THROWS_WITH(loadLabels(folder / "l.npy", options),
                    Contains("l.npy") && Contains("no voxel"));
  CHECK_THROWS_WITH(loadLabels(folder / "l.vdb", options),
                    Contains("l.vdb") && Contains("no voxel"));
}

TEST_CASE("scan_region: a mask in memory is the region that it is in a file", "[scan_region]") {
  const ScratchFolder folder;
  const std::string path = folder / "scan.tif", file = folder / "region.vdb";
  writeScan(path, roundScan(16));
  const auto region = MaskGrid::create();
  region->fill(CoordBBox(Coord(5, 4, 2), Coord(30, 33, 18)), true);
  region->tree().setValueOff(Coord(20, 20, 9));
  region->setName("object");
  setDomain(*region, kScanBox);
  writeVdb(file, {toBoolGrid(*region)});
  VolumeOptions options = above(150), other = options;
  options.region.mask = file;
  other.region.grid = region;
  const Loaded read = load(path, options), given = load(path, other);
  REQUIRE(given.object);
  CHECK(storedDomain(*given.object) == storedDomain(*read.object));
  CHECK(given.object->tree().hasSameTopology(read.object->tree()));
  CHECK_THAT(given.notes, Contains("left out"));

  other.region.grid = MaskGrid::create();
  CHECK_THAT(load(path, other).error, Contains("the region: all is 0"));
  setDomain(*region, CoordBBox(Coord(0), Coord(40, 36, 18)));
  other.region.grid = region;
  CHECK_THAT(load(path, other).error,
             Contains("the region: has 41x37x19 voxels and does not cover"));
}
