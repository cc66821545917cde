// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <memory>
#include <sstream>
#include <string>
#include <vector>

#include "command.h"
#include "given_option.h"
#include "input_options.h"
#include "outputs.h"
#include "parse.h"
#include "remerge_slabs.h"
#include "scan_option.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/base/limits.h"
#include "vdb_madf/files/output_set.h"
#include "vdb_madf/grids/grid_metadata.h"
#include "vdb_madf/intensity/gray_planes.h"
#include "vdb_madf/measure/measure_stability.h"
#include "vdb_madf/pictures/column_colors.h"
#include "vdb_madf/pictures/label_panels.h"
#include "vdb_madf/pictures/png_file.h"

namespace vdb_madf::tools {

namespace {

struct RenderArguments {
  InputOptions input;
  std::string out, only, slice, select, colorBy, with;
  ScanOption scan{"", "", "--overlay"};
  int size = 512, frames = 1;
  bool interfaces = false, noAxes = false, transparent = false;
  ViewOptions view;
  // Filled by parse().
  std::vector<SlicePlane> planes;
  std::vector<int32_t> selected;
};

constexpr int kLargest = 8192;                                     // pixels along a part
constexpr int64_t kMostPixels = 4 * int64_t(kLargest) * kLargest;  // of all parts

/// "z=100" with as many more, between commas, as one likes.
std::vector<SlicePlane> parseSlices(const std::string& text) {
  std::vector<SlicePlane> planes;
  if (text.empty()) return planes;
  for (const std::string& part : split(text, ',')) {
    const size_t axis = part.empty() ? std::string::npos : std::string("xyz").find(part[0]);
    if (axis == std::string::npos || part.size() < 3 || part[1] != '=')
      throw WrongUsage("--slice " + text + ": must be like z=100 or x=20,y=30,z=40, in voxels");
    const double index = parseNumber(part.substr(2), "--slice");
    if (index != std::floor(index) || std::abs(index) > kMaxCoordinate)
      throw WrongUsage("--slice " + part + ": must be a whole number of a voxel");
    planes.push_back({int(axis), int(index)});
  }
  return planes;
}

/// OUT.png, of several OUT_000.png and so on.
std::string frameName(const RenderArguments& o, int frame) {
  if (o.frames == 1) return o.out;
  return fmt::format("{}_{:03}.png", o.out.substr(0, o.out.size() - 4), frame);
}

void parse(RenderArguments& o) {
  if (!hasPngEnding(o.out)) throw WrongUsage(o.out + ": the output's ending must be .png");
  // Option::range() lets NaN pass.
  if (!std::isfinite(o.view.azimuth)) throw WrongUsage("--azimuth: not a finite number");
  if (!std::isfinite(o.view.elevation)) throw WrongUsage("--elevation: not a finite number");
  if (o.only == "view" && !o.slice.empty()) throw WrongUsage("--slice: --only view has no slices");
  if (o.only == "view" && !o.scan.path.empty())
    throw WrongUsage("--overlay: --only view has no slices");
  const ViewOptions usual;
  if (o.only == "slices" &&
      (o.view.azimuth != usual.azimuth || o.view.elevation != usual.elevation))
    throw WrongUsage("--azimuth, --elevation: --only slices has no view");
  if (!o.with.empty() && o.colorBy.empty())
    throw WrongUsage("--with: its columns are for --color-by COLUMN: give that, too");
  if (o.frames > 1 && o.only != "view") throw WrongUsage("--turn: it is of views: add --only view");
  o.planes = parseSlices(o.slice);
  if (int64_t(o.planes.size() + 1) * o.size * o.size > kMostPixels)
    throw WrongUsage(fmt::format("--slice: {} of {} pixels are too large a picture: lower --size",
                                 counted(int64_t(o.planes.size()), "slice"), o.size));
  o.selected = parseGrains(o.select, "--select");
  std::sort(o.selected.begin(), o.selected.end());
  for (int frame = 0; frame < o.frames; ++frame) o.input.outputs.push_back(frameName(o, frame));
  o.input.parse();
  checkScan(o.scan, o.input);
}

std::vector<GrayPlane> grayPlanes(const RenderArguments& o, const CoordBBox& box,
                                  const std::vector<SlicePlane>& given, const Int32Grid& about,
                                  const Common& common) {
  if (o.scan.path.empty()) return {};
  GrayScan scan = openScan(o.scan, o.input, common.progress);
  noteOfScan(o.scan.path, noteOnScan(scan, about), common.progress);
  const std::vector<SlicePlane> planes = given.empty() ? middlePlanes(box) : given;
  for (const SlicePlane& plane : planes)
    if (plane.index < box.min()[plane.axis] || plane.index > box.max()[plane.axis])
      return {};  // labelPanels() says it better
  return readGrayPlanes(scan, box, planes, common.progress);
}

std::string scaleText(double voxelsPerPixel) {
  const bool large = voxelsPerPixel < 1;
  std::ostringstream number;
  number.precision(3);
  number << (large ? 1 / voxelsPerPixel : voxelsPerPixel);
  if (number.str() == "1") return "1 pixel a voxel";
  return number.str() + (large ? " pixels a voxel" : " voxels a pixel");
}

/// Labels in a file, or in slabs.
struct Source {
  bool isInSlabs = false;
  LabelSlabs slabs;
  Int32Grid::ConstPtr labels;  ///< of slabs, without voxels
  CoordBBox box;
};

/// As boxOf().
CoordBBox boxOfSlabs(const LabelSlabs& labels, const Common& common) {
  if (const auto domain = storedDomain(*labels.about)) return domain->box();
  CoordBBox box;
  for (size_t s = 0; s < labels.slabCount(); ++s) {
    const CoordBBox slab = labels.read(s, common.progress)->evalActiveVoxelBoundingBox();
    if (!slab.empty()) box.expand(slab);
  }
  return box;
}

Source openSource(const RenderArguments& o, const Common& common) {
  Source source;
  source.isInSlabs = isInSlabs(o.input);
  if (source.isInSlabs) {
    source.slabs = openLabelSlabs(o.input, "--grid", common.progress);
    source.labels = source.slabs.about;
    source.box = boxOfSlabs(source.slabs, common);
  } else {
    source.labels = loadLabels(o.input, "--grid", common.progress);
    source.box = boxOf(*source.labels);
  }
  if (source.box.empty())
    throw InvalidInput(o.input.path + ": has no labels and no domain: nothing to show");
  return source;
}

void expandBySelected(const RenderArguments& o, const Int32Grid& labels, CoordBBox& box) {
  for (auto voxel = labels.cbeginValueOn(); voxel; ++voxel) {
    if (!std::binary_search(o.selected.begin(), o.selected.end(), *voxel)) continue;
    CoordBBox its;
    voxel.getBoundingBox(its);
    box.expand(its);
  }
}

/// Of the grains that are selected; empty if there are none.
CoordBBox boxOfSelected(const RenderArguments& o, const Source& source, const Common& common) {
  CoordBBox box;
  if (o.selected.empty()) return box;
  if (!source.isInSlabs) expandBySelected(o, *source.labels, box);
  for (size_t s = 0; source.isInSlabs && s < source.slabs.slabCount(); ++s)
    expandBySelected(o, *source.slabs.read(s, common.progress), box);
  box.intersect(source.box);
  return box;
}

ColumnColors colorsBy(const RenderArguments& o, const Source& source, const Common& common) {
  if (source.isInSlabs)
    throw InvalidInput("--color-by is of labels in one file: write these as one (convert)");
  Measurements measured = measure(*source.labels, {}, common.progress);
  if (o.colorBy == "born" || o.colorBy == "dies" || o.colorBy == "stability")
    measureStability(keptGraph(o.input, common.progress), measured);
  measured.extra.given = readGiven(o.with, *source.labels, common.progress);
  const std::string note = noteOnGiven(measured.extra.given, measured.grains);
  if (!note.empty()) common.progress->note(o.with + ": " + note);
  return columnColors(measured, o.colorBy);
}

PanelOptions panelOptions(const RenderArguments& o, const Source& source, const Common& common) {
  PanelOptions options;
  options.slices = o.only != "view";
  options.view = o.only != "slices";
  options.edge = o.size;
  options.direction = o.view;
  options.direction.turns = o.frames > 1;
  options.axes = !o.noAxes;
  options.select = o.selected;
  options.frame = boxOfSelected(o, source, common);
  options.planes = o.planes;
  if (o.planes.empty() && !options.frame.empty()) options.planes = middlePlanes(options.frame);
  options.gray = grayPlanes(o, source.box, options.planes, *source.labels, common);
  options.interfaces = o.interfaces;
  return options;
}

void print(const RenderArguments& o, const Picture& sheet, double voxelsPerPixel,
           const Int32Grid& labels) {
  std::cout << frameName(o, 0) << ": " << sheet.width << " x " << sheet.height << " pixels; ";
  if (o.only != "view")
    std::cout << (o.planes.empty() ? "middle slices x-y, x-z, y-z"
                                   : counted(int64_t(o.planes.size()), "slice"))
              << " (z up), " << scaleText(voxelsPerPixel)
              << (hasCubicVoxels(labels) ? "" : " along its shortest edge");
  if (o.only.empty()) std::cout << "; ";
  if (o.only != "slices")
    std::cout << "view from azimuth " << o.view.azimuth << ", elevation " << o.view.elevation
              << " degrees";
  if (o.frames > 1) std::cout << ", and " << o.frames - 1 << " more around z";
  std::cout << "\n";
}

void runRender(const RenderArguments& o, const Common& common) {
  for (const std::string& output : o.input.outputs) checkWritable(output);
  const Source source = openSource(o, common);
  PanelOptions options = panelOptions(o, source, common);
  std::optional<ColumnColors> columns;
  if (!o.colorBy.empty()) {
    columns = withFileName(o.input.path, [&] { return colorsBy(o, source, common); });
    options.colors = columns->colors;
  }
  double voxelsPerPixel = 1;
  const auto drawn = [&](int frame, const Rgb& background) {
    options.direction.background = background;
    options.direction.azimuth = o.view.azimuth + 360.0 * frame / o.frames;
    std::vector<PicturePanel> panels = withFileName(o.input.path, [&] {
      return source.isInSlabs ? labelPanels(source.slabs, source.box, options, common.progress)
                              : labelPanels(*source.labels, source.box, options, common.progress);
    });
    voxelsPerPixel = panels[0].voxelsPerPixel;
    if (columns) panels.push_back(colorScalePanel(*columns, o.size, background));
    return pictureSheet(panels, storedVoxelSize(*source.labels), background);
  };
  constexpr Rgb kWhite{255, 255, 255}, kBlack{0, 0, 0};
  OutputSet files;
  Picture sheet(0, 0, kWhite);
  for (int frame = 0; frame < o.frames; ++frame) {
    sheet = drawn(frame, kWhite);
    if (o.transparent)
      writePng(frameName(o, frame), sheet, drawn(frame, kBlack));
    else
      writePng(frameName(o, frame), sheet);
  }
  files.commit();
  common.progress->end();
  if (!common.quiet) print(o, sheet, voxelsPerPixel, *source.labels);
}

}  // namespace

void addRender(Verb command, Common& common, Action& action) {
  auto o = std::make_shared<RenderArguments>();
  Verb verb = addVerb(command, common, "render", "colored slices of labels and a shaded view",
                      "vdb_madf render grains.vdb grains.png --azimuth 60");
  verb.option("LABELS", o->input.path, "labels: VDB or integer image").required();
  verb.option("OUT.png", o->out, "the three middle slices and a view from outside").required();
  verb.option("--grid", o->input.gridName, "VDB input: the grid to take").typeName("NAME");
  verb.option("--only", o->only, "slices or view").oneOf({"slices", "view"});
  verb.option("--size", o->size, "edge of each part, about, in pixels")
      .range(16, kLargest)
      .showDefault();
  verb.option("--azimuth", o->view.azimuth, "of the view, degrees: 0 along y, 90 against x")
      .range(-360.0, 360.0)
      .showDefault();
  verb.option("--elevation", o->view.elevation, "of the view, degrees: 90 from above (z)")
      .range(-90.0, 90.0)
      .showDefault();
  verb.option("--slice", o->slice, "slices to show instead of the middle ones, by voxel: x=20,z=40")
      .typeName("AXIS=N,...");
  verb.option("--select", o->select,
              "shows these grains: the view is theirs, slices go through their middle")
      .typeName("A,B,...");
  verb.option("--color-by", o->colorBy,
              "colors grains by a column of measure, such as sphericity, with a scale")
      .typeName("COLUMN");
  verb.option("--with", o->with, kWithHelp).typeName("FILE.csv");
  verb.flag("--interfaces", o->interfaces, "shows of grains the voxels alone that touch another");
  o->scan.add(verb, "the gray scan: slices show it with the outlines of grains");
  verb.flag("--no-axes", o->noAxes, "the view without a box and names of axes");
  verb.option("--turn", o->frames, "so many views around z: OUT_000.png, OUT_001.png ...")
      .typeName("N")
      .range(2, 999);
  verb.flag("--transparent", o->transparent, "nothing behind grains and letters");
  o->input.addRaw(verb);
  o->input.addVoxelSize(verb);
  verb.onParsed([o, &common, &action] {
    parse(*o);
    action = [o, &common] { runRender(*o, common); };
  });
}

}  // namespace vdb_madf::tools
