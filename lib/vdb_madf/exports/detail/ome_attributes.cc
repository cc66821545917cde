// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/exports/detail/ome_attributes.h"

#include <nlohmann/json.hpp>

#include "vdb_madf/base/detail/text.h"
#include "vdb_madf/base/length_unit.h"
#include "vdb_madf/base/version.h"
#include "vdb_madf/grids/detail/world_transform.h"
#include "vdb_madf/grids/grid_metadata.h"

namespace vdb_madf::detail {

namespace {

using Json = nlohmann::ordered_json;

constexpr char kUnit[] = "micrometer";

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
  for (const char* axis : {"z", "y", "x"}) {
    Json one = {{"name", axis}, {"type", "space"}};
    if (!place.unit.empty()) one["unit"] = place.unit;
    image["axes"].push_back(one);
  }
  for (size_t i = 0; i < scales.size(); ++i)
    image["datasets"].push_back(
        {{"path", std::to_string(i)},
         {"coordinateTransformations", transformationsOf(place, scales[i])}});
  image["type"] = name == "object" ? "mean" : "most frequent";
  image["metadata"] = {{"method", "vdb_madf"}, {"version", kVersion}};
  return Json::array({image}).dump();
}

std::string imageLabel(const GrainTable& table, const GrainColors& colors, OmeVersion version) {
  return std::string("{") + (version == OmeVersion::v04 ? "\"version\": \"0.4\", " : "") +
         "\"colors\": " + colorsText(colors) + ", \"properties\": " + propertiesText(table) +
         ", \"source\": {\"image\": \"../../\"}}";
}

std::string omeAttributes(const std::vector<OmeMember>& members, OmeVersion version) {
  std::string text = version == OmeVersion::v05 ? "{\"ome\": {\"version\": \"0.5\"" : "{";
  for (const auto& [name, json] : members)
    text += (text.size() > 1 ? ", \"" : "\"") + name + "\": " + json;
  return text + (version == OmeVersion::v05 ? "}}" : "}");
}

}  // namespace vdb_madf::detail
