// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/report/report.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <vector>

#include "vdb_madf/base/errors.h"
#include "vdb_madf/base/version.h"
#include "vdb_madf/exports/measurement_files.h"
#include "vdb_madf/files/detail/output_stream.h"
#include "vdb_madf/grids/grid_metadata.h"
#include "vdb_madf/labels/grain_colors.h"
#include "vdb_madf/labels/reduced_labels.h"
#include "vdb_madf/measure/columns.h"
#include "vdb_madf/pictures/label_panels.h"
#include "vdb_madf/pictures/png_file.h"
#include "vdb_madf/report/detail/packed_bytes.h"
#include "vdb_madf/report/detail/packed_labels.h"
#include "vdb_madf/report/detail/packed_mesh.h"
#include "vdb_madf/report/detail/page_sources.h"
#include "vdb_madf/report/detail/page_text.h"
#include "vdb_madf/shapes/grain_mesh.h"

namespace vdb_madf {

namespace {

using Json = nlohmann::ordered_json;

constexpr int kSmoothing = 10;
/// Enough to look at, and for software that draws without a graphics card.
constexpr uint64_t kTrianglesOfGrain = 150, kFewestTriangles = 40000;
/// Labels with more than so many times the triangles that are wanted, or this number, are reduced
/// before they are meshed: simplifying takes some 10 microseconds and 200 bytes a triangle.
constexpr uint64_t kMostSimplified = 8, kMostMeshed = 3000000;
/// Of a point in the page, voxels (reduced ones, if the mesh is made of such).
constexpr double kMeshStep = 1.0 / 32;

std::string packed(const std::string& text) {
  detail::PackedBytes bytes;
  bytes.bytes(text.data(), text.size());
  return bytes.text();
}

Json toJson(const Coord& coord) {
  return {coord.x(), coord.y(), coord.z()};
}

/// Names and units of columns: "mm" to a power.
Json columnsJson(const std::vector<MeasureColumn>& columns) {
  Json json = Json::array();
  for (const MeasureColumn& column : columns)
    json.push_back({{"name", column.name}, {"power", column.power}});
  return json;
}

/// Index coordinates of reduced labels to those of the labels themselves.
void enlarge(GrainMesh& mesh, int factor) {
  for (openvdb::Vec3f& point : mesh.points)
    point = point * float(factor) + openvdb::Vec3f(float(factor - 1) / 2);
}

/// Makes the parts of a page.
class ReportPage {
 public:
  ReportPage(const Int32Grid& labels, const ReportOptions& options, Interrupter* interrupter)
      : labels_(labels), options_(options), interrupter_(interrupter) {
    begin("measure");
    measured_ = measure(labels, options.measure, interrupter);
    box_ = measured_.sample.box;
    if (box_.empty()) throw InvalidInput("has no labels and no domain: nothing to show");
    colors_ = grainColors(labels, interrupter);
    for (const GrainMeasures& grain : measured_.grains) ids_.push_back(grain.id);
  }

  /// The elements that hold the data.
  std::string data() {
    const MeasurementTexts texts =
        measurementTexts(measured_, {options_.labels, "", options_.density});
    std::string elements = jsonElement("sample", texts.sample);
    elements += detail::dataElement("grains", packed(texts.grains));
    elements += detail::dataElement("bonds", packed(texts.bonds));
    elements += colors();
    elements += slices();
    if (options_.maxTriangles > 0 && !ids_.empty()) elements += mesh();
    return jsonElement("about", about().dump(-1, ' ', false, Json::error_handler_t::replace)) +
           elements;
  }

  std::string title() const {
    if (!options_.title.empty()) return options_.title;
    const std::string name = std::filesystem::path(options_.labels).filename().string();
    return name.empty() ? "Grains" : name;
  }

  /// A picture element, for where there is no WebGL and for paper.
  std::string picture() {
    begin("picture");
    const PanelOptions panel{false, true, options_.pictureEdge, view_};
    const std::vector<PicturePanel> panels = labelPanels(labels_, box_, panel, interrupter_);
    const Picture sheet = pictureSheet(panels, storedVoxelSize(labels_));
    return "<img id=\"picture\" alt=\"The grains from outside\" width=\"" +
           std::to_string(sheet.width) + "\" height=\"" + std::to_string(sheet.height) +
           "\" src=\"data:image/png;base64," + detail::base64(pngBytes(sheet)) + "\">";
  }

  Report report() const {
    return {int64_t(measured_.grains.size()), int64_t(measured_.bonds.size()), triangles_,
            reduction_, 0};
  }

 private:
  void begin(const char* stage) {
    if (!interrupter_) return;
    interrupter_->start(stage);
    if (interrupter_->wasInterrupted()) throw Interrupted();
  }

  static std::string jsonElement(const std::string& id, const std::string& json) {
    return detail::jsonElement(id, json);
  }

  std::string colors() const {
    std::string bytes;
    for (const int32_t id : ids_)
      for (const uint8_t channel : colors_.colorOf(id)) bytes += char(channel);
    return detail::dataElement("colors", packed(bytes));
  }

  std::string slices() {
    begin("slices");
    reduction_ = reductionFor(box_, options_.maxSlice);
    const Int32Grid::ConstPtr reduced =
        reduction_ > 1 ? reduceLabels(labels_, reduction_, interrupter_) : nullptr;
    sliceBox_ = reduced ? boxOf(*reduced) : box_;
    return detail::dataElement(
        "labels", detail::packLabels(reduced ? *reduced : labels_, sliceBox_, ids_, interrupter_));
  }

  std::string mesh() {
    begin("mesh");
    const GrainMeshOptions options{
        kSmoothing, std::min(options_.maxTriangles,
                             std::max(kFewestTriangles, kTrianglesOfGrain * ids_.size()))};
    const uint64_t most =
        std::min(kMostMeshed, kMostSimplified * std::max(options.triangles, kFewestTriangles));
    const int factor = reductionForTriangles(labels_, most, 1, interrupter_);
    GrainMesh mesh =
        factor > 1 ? grainMesh(*reduceLabels(labels_, factor, interrupter_), options, interrupter_)
                   : grainMesh(labels_, options, interrupter_);
    if (factor > 1) enlarge(mesh, factor);
    const detail::PackedMesh packed =
        detail::packMesh(mesh, measured_.grains, kMeshStep * double(factor));
    triangles_ = packed.triangles;
    mesh_ = {{"step", packed.step}, {"points", packed.points}, {"triangles", packed.triangles}};
    return detail::dataElement("mesh", packed.text);
  }

  /// What the page has to know besides the tables.
  Json about() const {
    Json json;
    json["title"] = title();
    json["version"] = kVersion;
    json["unit"] = measured_.voxelSize ? measured_.voxelSize->unit() : "voxel";
    json["voxelSizeKnown"] = measured_.voxelSize.has_value();
    std::array<double, 3> edges{measured_.edges[0], measured_.edges[1], measured_.edges[2]};
    if (measured_.voxelSize) edges = measured_.voxelSize->edgesInUnit();
    json["edges"] = edges;
    json["box"] = {{"min", toJson(box_.min())}, {"max", toJson(box_.max())}};
    json["slices"] = {{"factor", reduction_},
                      {"min", toJson(sliceBox_.min())},
                      {"size", toJson(sliceBox_.dim())}};
    json["mesh"] = mesh_;
    json["view"] = {{"azimuth", view_.azimuth}, {"elevation", view_.elevation}};
    json["columns"] = {{"grains", columnsJson(grainColumns({}, measured_.extra))},
                       {"bonds", columnsJson(bondColumns({}, measured_.extra))}};
    return json;
  }

  const Int32Grid& labels_;
  const ReportOptions& options_;
  Interrupter* interrupter_;
  const ViewOptions view_;
  Measurements measured_;
  CoordBBox box_, sliceBox_;
  GrainColors colors_;
  std::vector<int32_t> ids_;
  int reduction_ = 1;
  uint64_t triangles_ = 0;
  Json mesh_;  ///< null: there is none
};

void checkOptions(const ReportOptions& options) {
  if (options.maxSlice < 1) throw InvalidInput("slices must have at least one voxel a side");
  if (options.pictureEdge < 16 || options.pictureEdge > 8192)
    throw InvalidInput("the picture must have from 16 to 8192 pixels a side");
}

}  // namespace

bool canWriteReport() {
  return detail::pageSources() != nullptr;
}

Report writeReport(const std::string& path, const Int32Grid& labels, const ReportOptions& options,
                   Interrupter* interrupter) {
  checkOptions(options);
  const detail::PageSources* sources = detail::pageSources();
  if (!sources)
    throw IoError(path +
                  ": reports cannot be written by this program: install esbuild, libjs-three and "
                  "libjs-jquery-datatables, then configure and build it again");
  detail::OutputStream file(path, interrupter);
  ReportPage page(labels, options, interrupter);
  uint64_t bytes = 0;
  detail::fillIn(
      sources->html,
      [&](const std::string& name) -> std::string {
        if (name == "TITLE") return detail::htmlEscaped(page.title());
        if (name == "STYLE") return sources->style;
        if (name == "PICTURE") return page.picture();
        if (name == "DATA") return page.data();
        if (name == "SCRIPT") return sources->script;
        throw std::logic_error("the page has an unknown part: " + name);
      },
      [&](const std::string& text) {
        file.text(text);
        bytes += text.size();
      });
  file.commit();
  Report report = page.report();
  report.bytes = bytes;
  return report;
}

}  // namespace vdb_madf
