// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/grids/grid_metadata.h"

#include <openvdb/Metadata.h>

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "support/catch.h"
#include "support/random_volume.h"
#include "vdb_madf/base/errors.h"

namespace {

using namespace vdb_madf;
using namespace vdb_madf::test;
using openvdb::DoubleMetadata;
using openvdb::StringMetadata;
using openvdb::Vec3d;
using openvdb::Vec3i;
using openvdb::Vec3IMetadata;

std::string textAt(const openvdb::MetaMap& metadata, const std::string& key) {
  const auto value = metadata.getMetadata<StringMetadata>(key);
  return value ? value->value() : "(absent)";
}

/// Keys and values of all metadata.
std::vector<std::string> all(const openvdb::MetaMap& metadata) {
  std::vector<std::string> result;
  for (auto entry = metadata.beginMeta(); entry != metadata.endMeta(); ++entry)
    result.push_back(entry->first + " = " + entry->second->str());
  return result;
}

}  // namespace

TEST_CASE("grid_metadata: a domain comes back", "[grid_metadata]") {
  Rng rng(1);
  std::vector<CoordBBox> boxes = {boxAt(Coord(0), Coord(1)), boxAt({-7, 3, -1}, {1, 20, 2}),
                                  boxAt({-1000000000, 0, 5}, {2000000000, 1, 1})};
  for (int i = 0; i < 20; ++i) boxes.push_back(boxAt(randomOrigin(rng), randomSize(rng)));
  openvdb::MetaMap metadata;
  CHECK_FALSE(storedDomain(metadata).has_value());
  for (const CoordBBox& box : boxes) {  // each replaces the one before
    setDomain(metadata, box);
    CAPTURE(toString(box));
    REQUIRE(storedDomain(metadata).has_value());
    CHECK(*storedDomain(metadata) == box);
    CHECK(metadata.metaCount() == 2);
  }
}

TEST_CASE("grid_metadata: a domain is its two corners, both inclusive", "[grid_metadata]") {
  openvdb::MetaMap metadata;
  setDomain(metadata, CoordBBox(Coord(-1, 2, 3), Coord(4, 5, 3)));
  CHECK(metadata.getMetadata<Vec3IMetadata>("madf_domain_min")->value() == Vec3i(-1, 2, 3));
  CHECK(metadata.getMetadata<Vec3IMetadata>("madf_domain_max")->value() == Vec3i(4, 5, 3));
}

TEST_CASE("grid_metadata: a domain beyond the largest coordinate is refused", "[grid_metadata]") {
  for (const int far : {1 << 30, 2147483647}) {
    openvdb::MetaMap metadata;
    setDomain(metadata, CoordBBox(Coord(0), Coord(5, far, 5)));
    CHECK_THROWS_AS(storedDomain(metadata), InvalidInput);
    setDomain(metadata, CoordBBox(Coord(5, 5, -far), Coord(6)));
    CHECK_THROWS_AS(storedDomain(metadata), InvalidInput);
  }
}

TEST_CASE("grid_metadata: half a domain, and an inverted one, are refused", "[grid_metadata]") {
  for (const char* left : {"madf_domain_min", "madf_domain_max"}) {
    openvdb::MetaMap metadata;
    metadata.insertMeta(left, Vec3IMetadata(Vec3i(1, 2, 3)));
    CAPTURE(left);
    CHECK_THROWS_AS(storedDomain(metadata), InvalidInput);
  }
  for (int axis = 0; axis < 3; ++axis) {
    Vec3i upper(3, 3, 3);
    openvdb::MetaMap metadata;
    metadata.insertMeta("madf_domain_min", Vec3IMetadata(Vec3i(3, 3, 3)));
    metadata.insertMeta("madf_domain_max", Vec3IMetadata(upper));
    CHECK(storedDomain(metadata)->voxelCount() == 1);
    --upper[axis];
    metadata.insertMeta("madf_domain_max", Vec3IMetadata(upper));
    CAPTURE(axis);
    CHECK_THROWS_AS(storedDomain(metadata), InvalidInput);
  }
}

TEST_CASE("grid_metadata: millimeters, below 20 nanometers micrometers", "[grid_metadata]") {
  CHECK(VoxelSize{8.5e-6}.unit() == "mm");
  CHECK(VoxelSize{8.5e-6}.inUnit() == Approx(0.0085));
  CHECK(VoxelSize{2}.unit() == "mm");
  CHECK(VoxelSize{2}.inUnit() == 2000);
  CHECK(VoxelSize{20e-9}.unit() == "mm");
  CHECK(VoxelSize{20e-9}.inUnit() == Approx(20e-6));
  const double below = std::nextafter(20e-9, 0);
  CHECK(VoxelSize{below}.unit() == "um");
  CHECK(VoxelSize{below}.inUnit() == Approx(0.02));
  CHECK(VoxelSize{1e-9}.unit() == "um");
  CHECK(VoxelSize{1e-9}.inUnit() == Approx(0.001));
  CHECK(VoxelSize({1e-6, 1e-6, 19e-9}).unit() == "um");  // by the shortest
  CHECK(VoxelSize({1e-6, 1e-6, 20e-9}).unit() == "mm");
}

TEST_CASE("grid_metadata: edges that nearly agree are those of a cube", "[grid_metadata]") {
  const VoxelSize cube({1e-6, 1.0009e-6, 1.0001e-6}), flat({1e-6, 4e-6, 2e-6});
  CHECK(cube.isCube());
  CHECK(cube.edge() == 1e-6);
  CHECK(cube.edges() == std::array<double, 3>{1e-6, 1e-6, 1e-6});
  CHECK_FALSE(VoxelSize({1e-6, 1e-6, 1.002e-6}).isCube());
  CHECK_FALSE(flat.isCube());
  CHECK(flat.shortestEdge() == 1e-6);
  CHECK(flat.meanEdge() == Approx(2e-6));
  CHECK_FALSE(areEdgesOfCube({0, 0, 0}));
}

TEST_CASE("grid_metadata: three edges come back and place the voxels", "[grid_metadata]") {
  for (const double scale : {1e-6, 3e-9, 2e-10}) {
    const std::array<double, 3> edges{0.5 * scale, 1.2 * scale, 3 * scale};
    const VoxelSize size(edges);
    const auto grid = Int32Grid::create();
    setVoxelSize(*grid, VoxelSize{1e-6});
    setVoxelSize(*grid, size);
    CHECK((*grid)["madf_voxel_size_m"] == nullptr);  // who knows cubes alone must not read one
    CHECK(storedVoxelSize(*grid)->edges() == edges);
    CHECK(textAt(*grid, "madf_length_unit") == size.unit());
    const Vec3d place = grid->indexToWorld(Coord(7, -2, 9));
    const auto inUnit = size.edgesInUnit();
    CHECK(place.eq(Vec3d(7 * inUnit[0], -2 * inUnit[1], 9 * inUnit[2]), 1e-12));
    CHECK_FALSE(hasCubicVoxels(*grid));
    CHECK(hasVoxelsAlongAxes(*grid));
    CHECK_THROWS_WITH(requireCubicVoxels(*grid, "weighing"),
                      vdb_madf::test::Contains("weighing needs cubic voxels"));

    const auto copy = Int32Grid::create();
    copyProvenance(*grid, *copy);
    CHECK(storedVoxelSize(*copy)->edges() == edges);
    CHECK(copy->transform() == grid->transform());
    setVoxelSize(*grid, VoxelSize{2e-6});
    CHECK(storedVoxelSize(*grid)->edge() == 2e-6);
    CHECK(hasCubicVoxels(*grid));
    CHECK_NOTHROW(requireCubicVoxels(*grid, "weighing"));
  }
}

TEST_CASE("grid_metadata: a voxel size comes back and places the voxels", "[grid_metadata]") {
  for (uint64_t seed = 1; seed <= 50; ++seed) {
    Rng rng(seed);
    const double metres = std::pow(10, -9 + 8 * rng.unit());
    CAPTURE(seed, metres);
    const auto grid = Int32Grid::create();
    setVoxelSize(*grid, VoxelSize{metres});
    REQUIRE(storedVoxelSize(*grid).has_value());
    CHECK(storedVoxelSize(*grid)->edge() == metres);
    CHECK(grid->getMetadata<DoubleMetadata>("madf_voxel_size_m")->value() == metres);
    CHECK(textAt(*grid, "madf_length_unit") == VoxelSize{metres}.unit());
    // The center of voxel p lies at p * size; the unit is the only thing between the two.
    const double edge = metres * (VoxelSize{metres}.unit() == "mm" ? 1e3 : 1e6);
    const Coord p(rng.between(-999, 999), rng.between(-999, 999), rng.between(-999, 999));
    const Vec3d place = grid->indexToWorld(p);
    for (int axis = 0; axis < 3; ++axis) CHECK(place[axis] == Approx(p[axis] * edge).margin(1e-15));
    CHECK(grid->worldToIndex(place).eq(p.asVec3d(), 1e-6));
  }
}

TEST_CASE("grid_metadata: proportions are a transform alone", "[grid_metadata]") {
  const auto grid = Int32Grid::create();
  setProportions(*grid, {1, 0.5, 3});
  CHECK(grid->indexToWorld(Coord(1, 1, 1)) == Vec3d(1, 0.5, 3));
  CHECK(all(*grid).empty());
  setProportions(*grid, {5e-7, 5e-7, 1.2e-6});  // meters, which OpenVDB would refuse
  const Vec3d place = grid->indexToWorld(Coord(1, 1, 1));
  CHECK(place.z() / place.x() == Approx(2.4).epsilon(1e-12));
  CHECK(place.y() == place.x());
}

TEST_CASE("grid_metadata: without a size one voxel is one unit", "[grid_metadata]") {
  const auto grid = Int32Grid::create();
  CHECK_FALSE(storedVoxelSize(*grid).has_value());
  setVoxelSize(*grid, VoxelSize{1e-8});
  setVoxelSize(*grid, VoxelSize{1e-5});  // another unit
  CHECK(textAt(*grid, "madf_length_unit") == "mm");
  setVoxelSize(*grid, std::nullopt);
  CHECK_FALSE(storedVoxelSize(*grid).has_value());
  CHECK(all(*grid).empty());
  CHECK(grid->indexToWorld(Coord(-3, 0, 7)) == Vec3d(-3, 0, 7));
}

TEST_CASE("grid_metadata: a size that is none counts as absent", "[grid_metadata]") {
  for (const double metres : {0.0, -1e-6, std::numeric_limits<double>::quiet_NaN()}) {
    openvdb::MetaMap metadata;
    metadata.insertMeta("madf_voxel_size_m", DoubleMetadata(metres));
    CAPTURE(metres);
    CHECK_FALSE(storedVoxelSize(metadata).has_value());
    openvdb::MetaMap edges;
    edges.insertMeta("madf_voxel_edges_m", openvdb::Vec3DMetadata(Vec3d(1e-6, metres, 1e-6)));
    CHECK_FALSE(storedVoxelSize(edges).has_value());
  }
}

TEST_CASE("grid_metadata: provenance is copied, and nothing else", "[grid_metadata]") {
  const auto from = FloatGrid::create();
  from->setName("from");
  setDomain(*from, boxAt({-4, 5, 6}, {7, 8, 9}));
  setVoxelSize(*from, VoxelSize{3e-6});
  from->transform().postTranslate(Vec3d(10, -20.5, 0.25));
  from->insertMeta("madf_source", StringMetadata("scan.tif"));
  from->insertMeta("madf_boundary", StringMetadata("open"));
  from->insertMeta("madf_theta", DoubleMetadata(-0.5));
  from->insertMeta("remark", StringMetadata("not ours"));
  const auto to = Int32Grid::create(0);
  to->setName("to");
  to->insertMeta("madf_source", StringMetadata("another.tif"));
  to->insertMeta("kept", StringMetadata("as it was"));
  copyProvenance(*from, *to);

  CHECK(to->getName() == "to");
  CHECK(storedDomain(*to) == storedDomain(*from));
  CHECK(storedVoxelSize(*to)->edge() == 3e-6);
  CHECK(textAt(*to, "madf_length_unit") == "mm");
  CHECK(textAt(*to, "madf_source") == "scan.tif");
  CHECK(textAt(*to, "madf_boundary") == "open");
  CHECK(textAt(*to, "kept") == "as it was");
  CHECK((*to)["madf_theta"] == nullptr);
  CHECK((*to)["remark"] == nullptr);
  CHECK(to->transform() == from->transform());
  // The transforms are two: moving the one leaves the other.
  const Vec3d place = to->indexToWorld(Coord(1, 2, 3));
  from->transform().postTranslate(Vec3d(1));
  CHECK(to->indexToWorld(Coord(1, 2, 3)) == place);
  // Once more it changes nothing.
  const std::vector<std::string> before = all(*to);
  copyProvenance(*to->deepCopy(), *to);
  CHECK(all(*to) == before);
}

TEST_CASE("grid_metadata: a grid that says nothing gives its transform", "[grid_metadata]") {
  const auto from = MaskGrid::create();
  const auto to = Int32Grid::create(0);
  setVoxelSize(*to, std::nullopt);
  to->transform().postTranslate(Vec3d(5));
  copyProvenance(*from, *to);
  CHECK(all(*to).empty());
  CHECK_FALSE(storedDomain(*to).has_value());
  CHECK(to->indexToWorld(Coord(1, 2, 3)) == Vec3d(1, 2, 3));
}

TEST_CASE("grid_metadata: labels made of tracked ones know the largest number of a track",
          "[grid_metadata]") {
  const auto tracked = Int32Grid::create(0), labels = Int32Grid::create(0);
  tracked->insertMeta(kLastTrackKey, openvdb::Int64Metadata(9));
  const auto mask = MaskGrid::create();
  copyProvenance(*tracked, *labels);
  copyProvenance(*tracked, *mask);
  CHECK(labels->metaValue<int64_t>(kLastTrackKey) == 9);
  CHECK((*mask)[kLastTrackKey] == nullptr);  // segmented, it has grains of its own
}
