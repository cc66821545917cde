// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/report/detail/report_parts.h"

#include <fmt/core.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <set>
#include <utility>

#include "vdb_madf/base/errors.h"
#include "vdb_madf/base/version.h"
#include "vdb_madf/exports/measurement_files.h"
#include "vdb_madf/files/file_name.h"
#include "vdb_madf/grids/grid_metadata.h"
#include "vdb_madf/intensity/gray_planes.h"
#include "vdb_madf/labels/reduced_labels.h"
#include "vdb_madf/measure/columns.h"
#include "vdb_madf/pictures/label_panels.h"
#include "vdb_madf/pictures/png_file.h"
#include "vdb_madf/report/detail/packed_bytes.h"
#include "vdb_madf/report/detail/packed_labels.h"
#include "vdb_madf/report/detail/packed_mesh.h"
#include "vdb_madf/report/detail/page_text.h"
#include "vdb_madf/shapes/grain_mesh.h"

namespace vdb_madf::detail {

namespace {

using Json = nlohmann::ordered_json;

constexpr int kSmoothing = 10;
/// Enough to look at, and for software that draws without a graphics card.
constexpr uint64_t kTrianglesOfGrain = 150, kFewestTriangles = 40000;
/// Labels with more than so many times the triangles that are wanted, or this number, are reduced
/// before they are meshed: simplifying takes some 10 microseconds and 200 bytes a triangle.
constexpr uint64_t kMostSimplified = 8, kMostMeshed = 3000000;
/// The step of a point in the page, voxels (reduced ones, if the mesh is made of such).
constexpr double kMeshStep = 1.0 / 32;

/// Of letters that are read on white and on the ground of a dark page.
constexpr Rgb kInk{120, 126, 132};
/// Grays under the slices: noise takes more of the file with each.
constexpr int kGrayLevels = 32;

std::string packed(const std::string& text) {
  PackedBytes bytes;
  bytes.bytes(text.data(), text.size());
  return bytes.text();
}

Json toJson(const Coord& coord) {
  return {coord.x(), coord.y(), coord.z()};
}

/// Names of columns, and their powers of the length.
Json columnsJson(const std::vector<MeasureColumn>& columns) {
  Json json = Json::array();
  for (const MeasureColumn& column : columns)
    json.push_back({{"name", column.name}, {"power", column.power}});
  return json;
}

Json listed(const PackedLeaves::Table& table) {
  Json columns = Json::array();
  for (const PackedLeaves::Column& column : table.columns)
    columns.push_back({{"name", column.name}, {"exact", column.isExact}});
  return {{"rows", table.rows}, {"columns", columns}};
}

/// The colors that are enough to tell these apart, each once.
Json paletteJson(const GrainColors& colors) {
  std::set<std::array<int, 3>> palette;
  for (const Rgb& color : colors.colors) palette.insert({color[0], color[1], color[2]});
  return palette;
}

/// In one grid; itself if it is one, and is not reduced.
Int32Grid::ConstPtr reduced(const AnyLabels& labels, int factor, Interrupter* interrupter) {
  if (const auto* const whole = std::get_if<Int32Grid::ConstPtr>(&labels))
    if (factor == 1) return *whole;
  return applied(labels, [&](const auto& fine) -> Int32Grid::ConstPtr {
    return reduceLabels(fine, factor, interrupter);
  });
}

/// How far to reduce labels for about so many triangles: the surface of a sample has a factor
/// squared less.
int reductionTo(uint64_t most, const AnyLabels& labels, Interrupter* interrupter) {
  const uint64_t all =
      applied(labels, [&](const auto& fine) { return countTriangles(fine, interrupter); });
  const double times = double(all) / double(most);
  return std::clamp(int(std::ceil(std::sqrt(times))), 1, kMaxReduction);
}

/// Index coordinates of reduced labels to those of the labels themselves.
void enlarge(GrainMesh& mesh, int factor) {
  for (openvdb::Vec3f& point : mesh.points)
    point = point * float(factor) + openvdb::Vec3f(float(factor - 1) / 2);
}

}  // namespace

ReportParts::ReportParts(const AnyLabels& labels, const ReportOptions& options, std::string suffix,
                         Interrupter* interrupter)
    : labels_(labels), options_(options), suffix_(std::move(suffix)), interrupter_(interrupter) {
  begin("measure");
  measured_ =
      applied(labels, [&](const auto& all) { return measure(all, options.measure, interrupter); });
  measured_.extra.given = options.given;
  box_ = sliceBox_ = measured_.sample.box;
  if (box_.empty()) throw InvalidInput("has no labels and no domain: nothing to show");
  if (options.scan) placeScan(*options.scan, box_);
  for (const GrainMeasures& grain : measured_.grains) ids_.push_back(grain.id);
  if (options.manifold && options.given.empty()) addLevels();
}

void ReportParts::addLevels() {
  begin("levels");
  levels_ = grainLevels(aboutOf(labels_), ids_, *options_.manifold, interrupter_);
  if (!levels_) return;
  MeasureOptions options = options_.measure;
  options.domain = options.domain ? options.domain : storedDomain(aboutOf(labels_));
  options.minFaces = 1;  // the page sums the faces of leaves before it counts them
  leafMeasures_ = applied(
      levels_->leaves, [&](const auto& leaves) { return measure(leaves, options, interrupter_); });
  if (leafMeasures_->grains.size() != levels_->grainOfLeaf.size())
    throw InvalidInput("the manifolds have no voxels of some that their graph has: segment again");
  packedLeaves_ = packLeaves(*leafMeasures_,
                             levelAreas(*levels_, *leafMeasures_, options.domain, interrupter_));
}

std::vector<int32_t> ReportParts::bodyIds() const {
  std::vector<int32_t> ids;
  for (const GrainMeasures& body : bodyMeasures().grains) ids.push_back(body.id);
  return ids;
}

void ReportParts::begin(const char* stage) const {
  if (!interrupter_) return;
  interrupter_->start(stage);
  if (interrupter_->wasInterrupted()) throw Interrupted();
}

std::string ReportParts::title() const {
  if (!options_.title.empty()) return options_.title;
  const std::string name = lastPart(options_.labels);
  return name.empty() ? "Grains" : name;
}

std::string ReportParts::unit() const {
  return measured_.voxelSize ? measured_.voxelSize->unit() : "voxel";
}

Report ReportParts::report() const {
  return {int64_t(measured_.grains.size()),
          int64_t(measured_.bonds.size()),
          triangles_,
          reduction_,
          levels_.has_value(),
          0,
          noteOnGiven(options_.given, measured_.grains)};
}

std::string ReportParts::tables() const {
  const MeasurementTexts texts =
      measurementTexts(measured_, {options_.labels, "", options_.density});
  return jsonElement("sample" + suffix_, texts.sample) +
         dataElement("grains" + suffix_, packed(texts.grains)) +
         dataElement("bonds" + suffix_, packed(texts.bonds));
}

std::string ReportParts::colors(const GrainColors& colors) const {
  std::string bytes;
  for (const int32_t id : ids_)
    for (const uint8_t channel : colors.colorOf(id)) bytes += char(channel);
  return dataElement("colors" + suffix_, packed(bytes));
}

std::string ReportParts::sweep() const {
  return options_.sweep.empty() ? "" : dataElement("sweep", packed(options_.sweep));
}

std::string ReportParts::slices() {
  begin("slices");
  reduction_ = reductionFor(box_, options_.maxSlice);
  const Int32Grid::ConstPtr sliced = reduced(bodies(), reduction_, interrupter_);
  if (reduction_ > 1) sliceBox_ = boxOf(*sliced);
  return dataElement("labels" + suffix_, packLabels(*sliced, sliceBox_, bodyIds(), interrupter_));
}

std::string ReportParts::gray() const {
  if (!options_.scan) return "";
  begin("scan");
  std::vector<uint8_t> gray = readGrayBlocks(*options_.scan, sliceBox_, reduction_, interrupter_);
  for (uint8_t& value : gray) value = uint8_t(value * kGrayLevels / 256);
  PackedBytes bytes;
  bytes.bytes(gray.data(), gray.size());
  return dataElement("gray" + suffix_, bytes.text());
}

std::string ReportParts::mesh() {
  if (options_.maxTriangles == 0 || ids_.empty()) return "";
  begin("mesh");
  const GrainMeshOptions options{
      kSmoothing,
      std::min(options_.maxTriangles,
               std::max(kFewestTriangles, kTrianglesOfGrain * bodyMeasures().grains.size()))};
  const uint64_t most =
      std::min(kMostMeshed, kMostSimplified * std::max(options.triangles, kFewestTriangles));
  const int factor = reductionTo(most, bodies(), interrupter_);
  GrainMesh mesh = grainMesh(*reduced(bodies(), factor, interrupter_), options, interrupter_);
  if (factor > 1) enlarge(mesh, factor);
  const PackedMesh packed = packMesh(mesh, bodyMeasures().grains, kMeshStep * double(factor));
  points_ = packed.points;
  triangles_ = packed.triangles;
  step_ = packed.step;
  return dataElement("mesh" + suffix_, packed.text);
}

std::string ReportParts::levels() const {
  if (!levels_) return "";
  return dataElement("joins" + suffix_, packJoins(*levels_)) +
         dataElement("leaves" + suffix_, packedLeaves_.text);
}

std::string ReportParts::about() const {
  Json json;
  json["title"] = title();
  json["version"] = kVersion;
  json["unit"] = unit();
  json["voxelSizeKnown"] = measured_.voxelSize.has_value();
  std::array<double, 3> edges{measured_.edges[0], measured_.edges[1], measured_.edges[2]};
  if (measured_.voxelSize) edges = measured_.voxelSize->edgesInUnit();
  json["edges"] = edges;
  json["box"] = {{"min", toJson(box_.min())}, {"max", toJson(box_.max())}};
  json["slices"] = {
      {"factor", reduction_}, {"min", toJson(sliceBox_.min())}, {"size", toJson(sliceBox_.dim())}};
  if (options_.scan) {
    json["gray"] = {{"scan", lastPart(options_.scan->image->path())}, {"levels", kGrayLevels}};
  }
  json["mesh"] = nullptr;
  if (triangles_ > 0)
    json["mesh"] = {{"step", step_}, {"points", points_}, {"triangles", triangles_}};
  json["view"] = {{"azimuth", view_.azimuth}, {"elevation", view_.elevation}};
  json["columns"] = {{"grains", columnsJson(grainColumns(measured_.grains, measured_.extra))},
                     {"bonds", columnsJson(bondColumns(measured_.bonds, measured_.extra))}};
  if (levels_) {
    const auto colorsOf = [&](const auto& leaves) { return grainColors(leaves, interrupter_); };
    json["levels"] = {{"lowest", levels_->lowest},
                      {"highest", levels_->highest},
                      {"own", levels_->own},
                      {"leaves", leafMeasures_->grains.size()},
                      {"empty", levels_->empty},
                      {"joins", levels_->joins.size()},
                      {"minFaces", measured_.minFaces},
                      {"palette", paletteJson(applied(levels_->leaves, colorsOf))},
                      {"tables",
                       {{"grains", listed(packedLeaves_.grains)},
                        {"contacts", listed(packedLeaves_.contacts)},
                        {"changes", listed(packedLeaves_.changes)},
                        {"steps", listed(packedLeaves_.joins)}}}};
  }
  // A file name need not be UTF-8: what is not is replaced.
  return jsonElement("about" + suffix_, json.dump(-1, ' ', false, Json::error_handler_t::replace));
}

std::string ReportParts::picture(const std::optional<GrainColors>& colors) const {
  begin("picture");
  PanelOptions panel{false, true, options_.pictureEdge, view_};
  panel.colors = colors;
  panel.direction.ink = kInk;
  const auto drawn = [&](const Rgb& background) {
    panel.direction.background = background;
    return pictureSheet(
        applied(labels_,
                [&](const auto& all) { return labelPanels(all, box_, panel, interrupter_); }),
        storedVoxelSize(aboutOf(labels_)), background, kInk);
  };
  const Picture sheet = drawn({255, 255, 255});
  return fmt::format(
      "<img id=\"picture{}\" alt=\"The grains from outside\" width=\"{}\" height=\"{}\" "
      "src=\"data:image/png;base64,{}\">\n",
      suffix_, sheet.width, sheet.height, base64(pngBytes(sheet, drawn({0, 0, 0}))));
}

}  // namespace vdb_madf::detail
