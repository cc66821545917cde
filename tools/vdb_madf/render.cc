// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include <cmath>
#include <iostream>
#include <memory>
#include <optional>

#include "command.h"
#include "input_options.h"
#include "outputs.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/grids/grid_metadata.h"
#include "vdb_madf/pictures/label_panels.h"
#include "vdb_madf/pictures/png_file.h"

namespace vdb_madf::tools {

namespace {

struct Options {
  InputOptions input;
  std::string out, only;
  int size = 512;
  ViewOptions view;
};

void run(const Options& o, const Common& common) {
  checkWritable(o.out);
  const Int32Grid::Ptr labels = loadLabels(o.input, "--grid", common.progress);
  const CoordBBox box = boxOf(*labels);
  if (box.empty())
    throw InvalidInput(o.input.path + ": has no labels and no domain: nothing to show");

  const PanelOptions options{o.only != "view", o.only != "slices", o.size, o.view};
  const std::vector<PicturePanel> panels = labelPanels(*labels, box, options, common.progress);
  writePng(o.out, pictureSheet(panels, storedVoxelSize(*labels)));
  common.progress->end();
  if (common.quiet) return;
  std::cout << o.out << ": ";
  if (o.only != "view")
    std::cout << "middle slices x-y, x-z, y-z (z up), "
              << (panels[0].voxelsPerPixel <= 1
                      ? counted(std::lround(1 / panels[0].voxelsPerPixel), "pixel") + " a voxel"
                      : counted(std::lround(panels[0].voxelsPerPixel), "voxel") + " a pixel")
              << (hasCubicVoxels(*labels) ? "" : " along its shortest edge");
  if (o.only.empty()) std::cout << "; ";
  if (o.only != "slices")
    std::cout << "view from azimuth " << o.view.azimuth << ", elevation " << o.view.elevation
              << " degrees";
  std::cout << "\n";
}

}  // namespace

void addRender(Verb command, Common& common, Action& action) {
  auto o = std::make_shared<Options>();
  Verb verb = addVerb(command, common, "render", "colored slices of labels and a shaded view",
                      "vdb_madf render grains.vdb grains.png --azimuth 60");
  verb.option("LABELS", o->input.path, "labels: VDB or integer image").required();
  verb.option("OUT.png", o->out, "the three middle slices and a view from outside").required();
  verb.option("--grid", o->input.gridName, "VDB input: the grid to take").typeName("NAME");
  verb.option("--only", o->only, "slices or view").oneOf({"slices", "view"});
  verb.option("--size", o->size, "edge of each part, about, in pixels")
      .range(16, 8192)
      .showDefault();
  verb.option("--azimuth", o->view.azimuth, "of the view, degrees: 0 along y, 90 against x")
      .range(-360.0, 360.0)
      .showDefault();
  verb.option("--elevation", o->view.elevation, "of the view, degrees: 90 from above (z)")
      .range(-90.0, 90.0)
      .showDefault();
  o->input.addRaw(verb);
  o->input.addVoxelSize(verb);
  verb.onParsed([o, &common, &action] {
    if (!hasPngEnding(o->out)) throw WrongUsage(o->out + ": the output's ending must be .png");
    // Option::range() lets NaN pass.
    if (!std::isfinite(o->view.azimuth)) throw WrongUsage("--azimuth: not a finite number");
    if (!std::isfinite(o->view.elevation)) throw WrongUsage("--elevation: not a finite number");
    o->input.outputs = {o->out};
    o->input.parse();
    action = [o, &common] { run(*o, common); };
  });
}

}  // namespace vdb_madf::tools
