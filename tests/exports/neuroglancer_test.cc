// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "support/catch.h"
#include "support/files.h"
#include "support/label_shapes.h"
#include "vdb_madf/exports/ome_zarr.h"
#include "vdb_madf/grids/grid_metadata.h"
#include "vdb_madf/labels/reduced_labels.h"
#include "vdb_madf/measure/columns.h"

// What writeOmeZarr() puts beside the labels for neuroglancer.

using namespace vdb_madf;
using namespace vdb_madf::test;
using Json = nlohmann::json;
namespace fs = std::filesystem;

TEST_CASE("neuroglancer: meshes, properties and state are those of the labels", "[neuroglancer]") {
  const ScratchFolder folder;
  LabelMap voxels = twoBalls(Coord(20), 9);
  for (const auto& one : marker()) voxels.insert(one);
  const auto grid = labelGrid(voxels);
  const std::array<double, 3> edges{2e-6, 1e-6, 4e-6};
  const openvdb::Vec3d nanometers(2000, 1000, 4000);
  setVoxelSize(*grid, VoxelSize(edges));
  const CoordBBox box = boxOf(*grid);
  OmeZarrOptions options;
  options.meshes = true;
  options.mesh.smoothing = 0;
  options.version = GENERATE(OmeVersion::v04, OmeVersion::v05, OmeVersion::v06);
  options.meshReduction = GENERATE(1, 2);
  writeOmeZarr(folder / "a.ome.zarr/", *grid, box, options);
  const std::string path = folder / "a.ome.zarr/neuroglancer/";

  CHECK(Json::parse(readFile(path + "mesh/info")) ==
        Json::parse(R"({"@type": "neuroglancer_legacy_mesh"})"));
  const int factor = options.meshReduction;
  std::map<int32_t, openvdb::BBoxd> boxes;
  std::map<int32_t, double> volumes;
  LabelMap meshed;
  const auto reduced = reduceLabels(*grid, factor);
  for (auto voxel = reduced->cbeginValueOn(); voxel; ++voxel) meshed[voxel.getCoord()] = *voxel;
  for (const auto& [p, label] : meshed) {
    const openvdb::Vec3d low = nanometers * (double(factor) * p.asVec3d() - openvdb::Vec3d(0.5));
    boxes[label].expand(low);
    boxes[label].expand(low + double(factor) * nanometers);
    volumes[label] += std::pow(factor, 3) * nanometers[0] * nanometers[1] * nanometers[2];
  }
  CHECK(size_t(std::distance(fs::directory_iterator(path + "mesh"), fs::directory_iterator())) ==
        2 * boxes.size() + 1);
  for (const auto& [label, wanted] : boxes) {
    const std::string name = std::to_string(label);
    CHECK(Json::parse(readFile(path + "mesh/" + name + ":0")) == Json({{"fragments", {name}}}));
    const std::string bytes = readFile(path + "mesh/" + name);
    uint32_t count = 0;
    std::memcpy(&count, bytes.data(), 4);
    REQUIRE(bytes.size() > 4 + 12 * size_t(count));
    REQUIRE((bytes.size() - 4 - 12 * size_t(count)) % 12 == 0);
    std::vector<openvdb::Vec3f> points(count);
    std::memcpy(points.data(), &bytes[4], 12 * size_t(count));
    std::vector<std::array<uint32_t, 3>> triangles((bytes.size() - 4 - 12 * size_t(count)) / 12);
    std::memcpy(triangles.data(), &bytes[4 + 12 * size_t(count)], 12 * triangles.size());
    openvdb::BBoxd found;
    double volume = 0;
    for (const openvdb::Vec3f& p : points) found.expand(openvdb::Vec3d(p));
    for (const auto& [a, b, c] : triangles) {
      REQUIRE(std::max({a, b, c}) < count);
      volume += openvdb::Vec3d(points[a]).dot(
                    openvdb::Vec3d(points[b]).cross(openvdb::Vec3d(points[c]))) /
                6;
    }
    CHECK(found == wanted);
    CHECK(volume == Approx(volumes[label]).epsilon(1e-6));  // seen from outside
  }

  const Measurements measured = measure(*grid);
  const auto columns = grainColumns(measured.grains);
  const Json properties = Json::parse(readFile(path + "properties/info"));
  CHECK(properties.at("@type") == "neuroglancer_segment_properties");
  const Json& found = properties.at("inline");
  REQUIRE(found.at("ids").size() == measured.grains.size());
  for (size_t i = 0; i < measured.grains.size(); ++i)
    CHECK(found["ids"][i] == std::to_string(measured.grains[i].id));
  size_t next = 0;
  for (size_t n = 1; n < columns.size(); ++n) {
    const auto& values = columns[n].values;
    if (std::any_of(values.begin(), values.end(), [](double v) { return std::isnan(v); })) continue;
    const Json& one = found.at("properties").at(next++);
    CAPTURE(columns[n].name);
    REQUIRE(one.at("values").size() == values.size());
    if (columns[n].name == "at_domain_face") {
      CHECK(one.at("type") == "tags");
      CHECK(one.at("tags") == Json::array({"at_domain_face"}));
    } else {
      CHECK(one.at("id") == columns[n].name + unitSuffix(columns[n].power, "mm"));
      CHECK(one.at("type") == "number");
    }
    for (size_t i = 0; i < values.size(); ++i) {
      const Json& value = one["values"][i];
      if (columns[n].name == "at_domain_face")
        CHECK(value == (values[i] > 0 ? Json::array({0}) : Json::array()));
      else
        CHECK(value.get<double>() ==
              Approx(scaled(columns[n], values[i], 1e-6 * nanometers)).epsilon(1e-8));
      if (one.value("data_type", "") == "uint32") CHECK(value.is_number_unsigned());
    }
  }
  CHECK(next == found.at("properties").size());
  CHECK(next > 20);

  const Json state = Json::parse(readFile(path + "state.json"));
  const std::string zarr = options.version == OmeVersion::v04 ? "zarr2" : "zarr3";
  CHECK(state.at("layers").at(1).at("source").at(0) ==
        zarr + "://http://localhost:8000/a.ome.zarr/labels/grain");
  CHECK(state["layers"][1].at("segments") == found["ids"]);
  CHECK(state["layers"][1].at("segmentColors").size() == measured.grains.size());
  for (size_t axis = 0; axis < 3; ++axis) {
    CHECK(state.at("dimensions").at(std::string(1, "xyz"[axis])).at(0).get<double>() ==
          Approx(edges[axis]));
    CHECK(state.at("position").at(axis).get<double>() ==
          Approx((box.min()[int(axis)] + box.max()[int(axis)]) / 2.0));
  }
}

TEST_CASE("neuroglancer: of very many grains no mesh is shown until it is chosen",
          "[neuroglancer]") {
  const ScratchFolder folder;
  LabelMap voxels;
  for (int i = 0; i < 5001; ++i) voxels[Coord(2 * (i % 100), 2 * (i / 100), 0)] = i + 1;
  const auto grid = labelGrid(voxels);
  setVoxelSize(*grid, VoxelSize{1e-6});
  OmeZarrOptions options;
  options.meshes = true;
  options.mesh.smoothing = 0;
  writeOmeZarr(folder / "a.zarr", *grid, boxOf(*grid), options);
  const Json state = Json::parse(readFile(folder / "a.zarr/neuroglancer/state.json"));
  CHECK(state.at("layers").at(1).at("segments").empty());
  CHECK(state["layers"][1].at("segmentColors").size() == voxels.size());
}
