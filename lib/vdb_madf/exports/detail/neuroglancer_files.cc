// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/exports/detail/neuroglancer_files.h"

#include <algorithm>
#include <cstdio>
#include <limits>
#include <nlohmann/json.hpp>

#include "vdb_madf/base/detail/parallel.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/base/length_unit.h"
#include "vdb_madf/grids/grid_metadata.h"
#include "vdb_madf/labels/reduced_labels.h"
#include "vdb_madf/shapes/grain_mesh.h"

namespace vdb_madf::detail {

namespace {

using SortedJson = nlohmann::json;  // of many colors: ordered_json would look for each among all

const std::string kFolder = "neuroglancer/";
constexpr char kFaceColumn[] = "at_domain_face";
/// Meshes of more grains are shown only once they are chosen: to load all takes a browser long.
constexpr size_t kMostShown = 5000;
/// A section is about as large on most screens.
constexpr double kViewPixels = 400;

template <typename T>
void append(std::string& bytes, const T& value) {
  bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
}

/// Number of points, points, triangles.
std::string meshBytes(const GrainMesh& mesh, size_t grain,
                      const openvdb::math::Transform& transform, double nanometers) {
  const uint32_t first = mesh.firstPoint[grain], end = mesh.firstPoint[grain + 1];
  std::string bytes;
  append(bytes, end - first);
  for (uint32_t i = first; i < end; ++i)
    append(bytes,
           openvdb::Vec3f(nanometers * transform.indexToWorld(openvdb::Vec3d(mesh.points[i]))));
  for (uint32_t i = mesh.firstTriangle[grain]; i < mesh.firstTriangle[grain + 1]; ++i)
    for (const uint32_t corner : mesh.triangles[i]) append(bytes, corner - first);
  return bytes;
}

void writeMeshes(const OutputTree& folder, const Int32Grid& labels, const OmeZarrOptions& options,
                 Interrupter* interrupter) {
  const Int32Grid::ConstPtr meshed = options.meshReduction == 1
                                         ? labels.copy()
                                         : reduceLabels(labels, options.meshReduction, interrupter);
  const GrainMesh mesh = grainMesh(*meshed, options.mesh, interrupter);
  const double nanometers =
      unitsPerMetre("nm").value() / unitsPerMetre(storedVoxelSize(labels)->unit()).value();
  folder.write(kFolder + "mesh/info", "{\"@type\": \"neuroglancer_legacy_mesh\"}\n");
  const auto transform = transformInUnitOf(labels, *meshed);
  parallelForEach(mesh.labels.size(), 1, interrupter, [&](size_t grain) {
    const std::string label = std::to_string(mesh.labels[grain]);
    folder.write(kFolder + "mesh/" + label + ":0", "{\"fragments\": [\"" + label + "\"]}\n");
    folder.write(kFolder + "mesh/" + label, meshBytes(mesh, grain, *transform, nanometers));
  });
}

/// valueOf(row) of all rows, as an array.
template <typename ValueOf>
std::string listOf(const GrainTable& table, const ValueOf& valueOf) {
  std::string text = "[";
  for (size_t row = 0; row < table.rows(); ++row) text += (row ? ", " : "") + valueOf(row);
  return text + "]";
}

bool isKnownOfAll(const GrainTable& table, size_t column) {
  for (size_t row = 0; row < table.rows(); ++row)
    if (!table.isKnown(row, column)) return false;
  return true;
}

/// Whole numbers as far as the format has them.
bool areUint32(const MeasureColumn& column) {
  for (const double value : column.values)
    if (!(value >= 0 && value <= std::numeric_limits<uint32_t>::max())) return false;
  return column.isWhole();
}

std::string segmentPropertiesText(const GrainTable& table) {
  std::string text = "{\"@type\": \"neuroglancer_segment_properties\", \"inline\": {\"ids\": " +
                     listOf(table, [&](size_t row) { return "\"" + table.number(row, 0) + "\""; }) +
                     ",\n\"properties\": [";
  bool isFirst = true;
  for (size_t column = 1; column < table.columns(); ++column) {
    if (!isKnownOfAll(table, column)) continue;
    text += isFirst ? "\n" : ",\n";
    isFirst = false;
    if (table.column(column).name == kFaceColumn)
      text += std::string("{\"id\": \"tags\", \"type\": \"tags\", \"tags\": [\"") + kFaceColumn +
              "\"], \"values\": " + listOf(table, [&](size_t row) -> std::string {
                return table.column(column).values[row] > 0 ? "[0]" : "[]";
              });
    else
      text += "{\"id\": \"" + table.name(column) + "\", \"type\": \"number\", \"data_type\": \"" +
              (areUint32(table.column(column)) ? "uint32" : "float32") + "\", \"values\": " +
              listOf(table, [&](size_t row) { return table.number(row, column); });
    text += "}";
  }
  return text + "]}}\n";
}

/// The volume as a whole: units along the axes are the edges of voxels, lengths on the screen the
/// shortest of them.
void setView(SortedJson& state, const CoordBBox& box, const OmePlace& place) {
  const double metres = 1 / unitsPerMetre(place.unit).value();
  const double shortest = std::min({place.edges[0], place.edges[1], place.edges[2]});
  double longest = 0;
  for (size_t axis = 0; axis < 3; ++axis) {
    const double edge = place.edges[axis];
    const int low = box.min()[int(axis)], high = box.max()[int(axis)];
    state["dimensions"][std::string(1, "xyz"[axis])] = {edge * metres, "m"};
    state["position"].push_back(place.origin[axis] / edge + (double(low) + high) / 2);
    longest = std::max(longest, (double(high) - low + 1) * edge / shortest);
  }
  state["crossSectionScale"] = longest / kViewPixels;
  state["projectionScale"] = 2 * longest;
}

/// The state for a server on this machine.
SortedJson stateOf(const std::string& name, const CoordBBox& box, const OmePlace& place,
                   const GrainColors& colors, OmeVersion version) {
  const std::string url = "http://localhost:8000/" + name;
  const std::string zarr = version == OmeVersion::v04 ? "zarr2://" : "zarr3://";
  SortedJson shown = SortedJson::array(), palette = SortedJson::object();
  for (size_t i = 0; i < colors.labels.size(); ++i) {
    const Rgb& c = colors.colors[i];
    char text[8];
    std::snprintf(text, sizeof text, "#%02x%02x%02x", unsigned(c[0]), unsigned(c[1]),
                  unsigned(c[2]));
    palette[std::to_string(colors.labels[i])] = text;
    // (Where some are chosen, sections show no others; where none is, they show all.)
    if (colors.labels.size() <= kMostShown) shown.push_back(std::to_string(colors.labels[i]));
  }
  SortedJson grain, object, state;
  grain["type"] = "segmentation";
  grain["name"] = "grain";
  grain["source"] = {zarr + url + "/labels/grain", "precomputed://" + url + "/" + kFolder + "mesh",
                     "precomputed://" + url + "/" + kFolder + "properties"};
  grain["tab"] = "segments";  // the list, with the measures and filters by them
  grain["segments"] = shown;
  grain["segmentColors"] = palette;
  object["type"] = "image";
  object["name"] = "object";
  object["source"] = zarr + url;
  object["visible"] = false;
  setView(state, box, place);
  state["layers"] = SortedJson::array({object, grain});
  state["selectedLayer"] = {{"layer", "grain"}, {"visible", true}};
  state["layout"] = "4panel";
  return state;
}

}  // namespace

void checkNeuroglancer(const Int32Grid& labels, const OmeZarrOptions& options) {
  if (options.meshes && !storedVoxelSize(labels))
    throw InvalidInput(
        "neuroglancer's meshes are in nanometers, and the voxel size is not known: give it, or "
        "leave out the meshes");
}

void writeNeuroglancer(const OutputTree& folder, const std::string& name, const Int32Grid& labels,
                       const CoordBBox& box, const OmePlace& place, const GrainTable& table,
                       const GrainColors& colors, const OmeZarrOptions& options,
                       Interrupter* interrupter) {
  writeMeshes(folder, labels, options, interrupter);
  folder.write(kFolder + "properties/info", segmentPropertiesText(table));
  const SortedJson state = stateOf(name, box, place, colors, options.version);
  folder.write(kFolder + "state.json",
               state.dump(1, ' ', false, SortedJson::error_handler_t::replace) + "\n");
}

}  // namespace vdb_madf::detail
