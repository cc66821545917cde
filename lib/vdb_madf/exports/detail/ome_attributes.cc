// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/exports/detail/ome_attributes.h"

#include <nlohmann/json.hpp>

#include "vdb_madf/base/detail/text.h"
#include "vdb_madf/base/length_unit.h"
#include "vdb_madf/base/version.h"
#include "vdb_madf/exports/detail/ome_levels.h"
#include "vdb_madf/grids/detail/world_transform.h"
#include "vdb_madf/grids/grid_metadata.h"

namespace vdb_madf::detail {

namespace {

using Json = nlohmann::ordered_json;

constexpr char kUnit[] = "micrometer";
/// The coordinate system of all images.
constexpr char kSystem[] = "physical";

/// A scale and a translation: from voxels of a level to coordinates.
Json transformationsOf(const OmePlace& place, const OmeScale& level) {
  Json scale = Json::array(), translation = Json::array();
  for (const int axis : {2, 1, 0}) {
    const double edge = place.edges[size_t(axis)];
    scale.push_back(edge * level.factor);
    const double first =
        double(level.factor) * level.first[axis] + (level.factor - 1) / 2.0;  // its center
    translation.push_back(place.origin[size_t(axis)] + first * edge);
  }
  return Json::array({{{"type", "scale"}, {"scale", scale}},
                      {{"type", "translation"}, {"translation", translation}}});
}

/// Of OME-Zarr 0.6: where coordinates of one system lie in another.
Json between(const char* type, const Json& from, const Json& to) {
  return {{"type", type}, {"input", from}, {"output", to}};
}

/// The same from the array of a level.
Json fromArray(const std::string& array, const Json& steps) {
  Json json = between("sequence", {{"path", array}}, {{"name", kSystem}});
  json["transformations"] = steps;
  return json;
}

bool isIdentity(const openvdb::Mat3d& m) {
  constexpr double kRounding = 1e-12;
  return m.eq(openvdb::Mat3d::identity(), kRounding);
}

/// Rows and columns as z, y, x.
Json matrixJson(const openvdb::Mat3d& m, const openvdb::Vec3d* shift) {
  Json rows = Json::array();
  for (const int row : {2, 1, 0}) {
    Json one = {m(row, 2), m(row, 1), m(row, 0)};
    if (shift) one.push_back((*shift)[row]);
    rows.push_back(one);
  }
  return rows;
}

std::string colorsText(const GrainColors& colors) {
  std::string text = "[";
  for (size_t i = 0; i < colors.labels.size(); ++i) {
    text += (i ? ",\n" : "\n") + std::string("{\"label-value\": ") +
            std::to_string(colors.labels[i]) + ", \"rgba\": [";
    for (const uint8_t channel : colors.colors[i]) text += std::to_string(channel) + ", ";
    text += "255]}";
  }
  return text + "]";
}

std::string propertiesText(const GrainTable& table) {
  std::string text = "[";
  for (size_t row = 0; row < table.rows(); ++row) {
    text += (row ? ",\n" : "\n") + std::string("{\"label-value\": ") + table.number(row, 0);
    for (size_t i = 1; i < table.columns(); ++i)
      if (table.isKnown(row, i)) text += ", \"" + table.name(i) + "\": " + table.number(row, i);
    text += "}";
  }
  return text + "]";
}

}  // namespace

OmePlace omePlaceOf(const openvdb::GridBase& grid) {
  const WorldTransform world = worldTransform(grid.transform());
  OmePlace place;
  const auto size = storedVoxelSize(grid);
  double unitsPerWorld = 1;
  if (size) {
    const double perMetre = unitsPerMetre(kUnit).value();
    unitsPerWorld = perMetre / unitsPerMetre(size->unit()).value();
    place.unit = kUnit;
    const auto decimals = lengthsIn(perMetre, size->edges());
    for (size_t axis = 0; axis < 3; ++axis)
      place.edges[axis] = reals(decimals[axis]).value().front();
  }
  for (int axis = 0; axis < 3; ++axis) {
    place.origin[size_t(axis)] = world.origin[axis] * unitsPerWorld;
    if (!size) place.edges[size_t(axis)] = world.edges[axis];
  }
  return place;
}

std::string multiscales(const std::string& name, const OmePlace& place,
                        const std::vector<OmeScale>& scales, OmeVersion version) {
  Json image;
  if (version == OmeVersion::v04) image["version"] = "0.4";
  image["name"] = name;
  Json axes = Json::array();
  for (const char* axis : {"z", "y", "x"}) {
    Json one = {{"name", axis}, {"type", "space"}};
    if (!place.unit.empty()) one["unit"] = place.unit;
    axes.push_back(one);
  }
  const bool hasSystems = version == OmeVersion::v06;
  if (hasSystems)
    image["coordinateSystems"] = Json::array({{{"name", kSystem}, {"axes", axes}}});
  else
    image["axes"] = axes;
  for (size_t i = 0; i < scales.size(); ++i) {
    const std::string array = std::to_string(i);
    const Json steps = transformationsOf(place, scales[i]);
    image["datasets"].push_back({{"path", array},
                                 {"coordinateTransformations",
                                  hasSystems ? Json::array({fromArray(array, steps)}) : steps}});
  }
  if (hasSystems && name == "object")
    image["coordinateTransformations"] = Json::array(
        {between("identity", {{"name", kSystem}}, {{"name", kSystem}, {"path", kLabelGroup}})});
  image["type"] = name == "object" ? "mean" : "most frequent";
  image["metadata"] = {{"method", "vdb_madf"}, {"version", kVersion}};
  return Json::array({image}).dump();
}

std::string sceneText(const std::array<std::string, 2>& paths,
                      const std::array<OmePlace, 2>& places, const openvdb::Mat3d& linear,
                      const openvdb::Vec3d& shift) {
  openvdb::Mat3d matrix;
  openvdb::Vec3d move;
  for (int row = 0; row < 3; ++row) {
    const double edge = places[1].edges[size_t(row)];
    move[row] = places[1].origin[size_t(row)] + edge * shift[row];
    for (int column = 0; column < 3; ++column) {
      matrix(row, column) = edge * linear(row, column) / places[0].edges[size_t(column)];
      move[row] -= matrix(row, column) * places[0].origin[size_t(column)];
    }
  }
  const auto system = [](const std::string& path) {
    return Json{{"path", path}, {"name", kSystem}};
  };
  const Json translation = {move[2], move[1], move[0]};
  Json json;
  if (isIdentity(matrix)) {
    json = between("translation", system(paths[0]), system(paths[1]));
    json["translation"] = translation;
  } else if (isIdentity(matrix * matrix.transpose()) && matrix.det() > 0) {
    json = between("sequence", system(paths[0]), system(paths[1]));
    json["transformations"] =
        Json::array({{{"type", "rotation"}, {"rotation", matrixJson(matrix, nullptr)}},
                     {{"type", "translation"}, {"translation", translation}}});
  } else {
    json = between("affine", system(paths[0]), system(paths[1]));
    json["affine"] = matrixJson(matrix, &move);
  }
  return Json({{"coordinateTransformations", Json::array({json})}}).dump();
}

std::string imageLabel(const GrainTable& table, const GrainColors& colors, OmeVersion version) {
  return std::string("{") + (version == OmeVersion::v04 ? "\"version\": \"0.4\", " : "") +
         "\"colors\": " + colorsText(colors) + ", \"properties\": " + propertiesText(table) +
         ", \"source\": {\"image\": \"../../\"}}";
}

std::string omeAttributes(const std::vector<OmeMember>& members, OmeVersion version) {
  const bool isNamed = version != OmeVersion::v04;
  std::string text = "{";
  if (isNamed)
    text += std::string("\"ome\": {\"version\": \"") +
            (version == OmeVersion::v05 ? "0.5" : "0.6") + "\"";
  for (const auto& [name, json] : members)
    text += (text.size() > 1 ? ", \"" : "\"") + name + "\": " + json;
  return text + (isNamed ? "}}" : "}");
}

}  // namespace vdb_madf::detail
