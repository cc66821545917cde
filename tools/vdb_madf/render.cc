// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include <fmt/core.h>

#include <cmath>
#include <iostream>
#include <limits>
#include <memory>
#include <sstream>
#include <string>
#include <vector>

#include "command.h"
#include "input_options.h"
#include "outputs.h"
#include "parse.h"
#include "scan_option.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/base/limits.h"
#include "vdb_madf/grids/grid_metadata.h"
#include "vdb_madf/intensity/gray_planes.h"
#include "vdb_madf/pictures/label_panels.h"
#include "vdb_madf/pictures/png_file.h"

namespace vdb_madf::tools {

namespace {

struct RenderArguments {
  InputOptions input;
  std::string out, only, slice, select, scan, scanGrid;
  int size = 512;
  bool interfaces = false, noAxes = false;
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

void parse(RenderArguments& o) {
  if (!hasPngEnding(o.out)) throw WrongUsage(o.out + ": the output's ending must be .png");
  // Option::range() lets NaN pass.
  if (!std::isfinite(o.view.azimuth)) throw WrongUsage("--azimuth: not a finite number");
  if (!std::isfinite(o.view.elevation)) throw WrongUsage("--elevation: not a finite number");
  if (o.only == "view" && !o.slice.empty()) throw WrongUsage("--slice: --only view has no slices");
  if (o.only == "view" && !o.scan.empty()) throw WrongUsage("--overlay: --only view has no slices");
  o.planes = parseSlices(o.slice);
  if (int64_t(o.planes.size() + 1) * o.size * o.size > kMostPixels)
    throw WrongUsage(fmt::format("--slice: {} of {} pixels are too large a picture: lower --size",
                                 counted(int64_t(o.planes.size()), "slice"), o.size));
  o.selected = parseGrains(o.select, "--select");
  o.input.outputs = {o.out};
  o.input.parse();
  checkScan({o.scan, o.scanGrid, "--overlay"}, o.input);
}

std::vector<GrayPlane> grayPlanes(const RenderArguments& o, const CoordBBox& box,
                                  const Common& common) {
  if (o.scan.empty()) return {};
  GrayScan scan = openScan({o.scan, o.scanGrid, "--overlay"}, o.input, common.progress);
  const std::vector<SlicePlane> planes = o.planes.empty() ? middlePlanes(box) : o.planes;
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

void runRender(const RenderArguments& o, const Common& common) {
  checkWritable(o.out);
  const bool areInSlabs = isInSlabs(o.input);
  LabelSlabs slabs;
  Int32Grid::ConstPtr labels;  // of slabs, without voxels
  if (areInSlabs) {
    slabs = openLabelSlabs(o.input, "--grid", common.progress);
    labels = slabs.about;
  } else {
    labels = loadLabels(o.input, "--grid", common.progress);
  }
  const CoordBBox box = areInSlabs ? boxOfSlabs(slabs, common) : boxOf(*labels);
  if (box.empty())
    throw InvalidInput(o.input.path + ": has no labels and no domain: nothing to show");

  PanelOptions options;
  options.slices = o.only != "view";
  options.view = o.only != "slices";
  options.edge = o.size;
  options.direction = o.view;
  options.axes = !o.noAxes;
  options.planes = o.planes;
  options.gray = grayPlanes(o, box, common);
  options.select = o.selected;
  options.interfaces = o.interfaces;
  const std::vector<PicturePanel> panels = withFileName(o.input.path, [&] {
    return areInSlabs ? labelPanels(slabs, box, options, common.progress)
                      : labelPanels(*labels, box, options, common.progress);
  });
  const Picture sheet = pictureSheet(panels, storedVoxelSize(*labels));
  writePng(o.out, sheet);
  common.progress->end();
  if (common.quiet) return;
  std::cout << o.out << ": " << sheet.width << " x " << sheet.height << " pixels; ";
  if (options.slices)
    std::cout << (o.planes.empty() ? "middle slices x-y, x-z, y-z"
                                   : counted(int64_t(o.planes.size()), "slice"))
              << " (z up), " << scaleText(panels[0].voxelsPerPixel)
              << (hasCubicVoxels(*labels) ? "" : " along its shortest edge");
  if (o.only.empty()) std::cout << "; ";
  if (options.view)
    std::cout << "view from azimuth " << o.view.azimuth << ", elevation " << o.view.elevation
              << " degrees";
  std::cout << "\n";
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
  verb.option("--select", o->select, "shows these grains; in slices the others are pale")
      .typeName("A,B,...");
  verb.flag("--interfaces", o->interfaces, "shows of grains the voxels alone that touch another");
  verb.option("--overlay", o->scan, "the gray scan: slices show it with the outlines of grains")
      .typeName("FILE");
  verb.option("--overlay-grid", o->scanGrid,
              "of that scan: the grid of a VDB, the array of a Zarr or HDF5 file")
      .typeName("NAME");
  verb.flag("--no-axes", o->noAxes, "the view without a box and names of axes");
  o->input.addRaw(verb);
  o->input.addVoxelSize(verb);
  verb.onParsed([o, &common, &action] {
    parse(*o);
    action = [o, &common] { runRender(*o, common); };
  });
}

}  // namespace vdb_madf::tools
