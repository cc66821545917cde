// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include <algorithm>
#include <cmath>
#include <iostream>
#include <memory>
#include <optional>

#include "bitmap_font.h"
#include "command.h"
#include "input_options.h"
#include "outputs.h"
#include "png_file.h"
#include "scale_bar.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/grids/grid_metadata.h"
#include "vdb_madf/labels/grain_colors.h"
#include "vdb_madf/pictures/grain_view.h"

namespace vdb_madf::tools {

namespace {

struct Options {
  InputOptions input;
  std::string out, only;
  int size = 512;
  ViewOptions view;
};

constexpr Rgb kBackground{18, 20, 26}, kMargin{255, 255, 255}, kInk{40, 40, 40};
constexpr int kGap = 12;          // pixels between panels, and around them
constexpr int kCaptionScale = 2;  // pixels of the picture per pixel of a letter
constexpr int kCaptionHeight = 32;
constexpr int kFinest = 2;  ///< the view is drawn with so many rays along each edge of a pixel

/// A picture with its name and how large it is.
struct Panel {
  Picture picture;
  std::string caption;
  double voxelsPerPixel;
};

/// Labels of the plane where one coordinate is fixed; `right` and `down` are the other axes.
struct Slice {
  int width, height;
  std::vector<int32_t> labels;
};

Slice cutSlice(const Int32Grid& grid, const CoordBBox& box, int fixedAxis, int right, int down) {
  const int at = box.min()[fixedAxis] + (box.max()[fixedAxis] - box.min()[fixedAxis]) / 2;
  const Coord size = box.extents();
  Slice slice{size[right], size[down], {}};
  slice.labels.assign(size_t(slice.width) * slice.height, 0);
  for (auto leaf = grid.constTree().cbeginLeaf(); leaf; ++leaf) {
    const int inLeaf = at - leaf->origin()[fixedAxis];
    if (inLeaf < 0 || inLeaf > 7) continue;
    for (auto voxel = leaf->cbeginValueOn(); voxel; ++voxel) {
      const Coord p = voxel.getCoord();
      if (p[fixedAxis] != at || !box.isInside(p)) continue;
      // x-y as image viewers show it; z is up.
      const int row = down == 2 ? box.max().z() - p.z() : p[down] - box.min()[down];
      slice.labels[size_t(row) * slice.width + (p[right] - box.min()[right])] = *voxel;
    }
  }
  return slice;
}

/// Whole pixels per voxel (> 0, small samples) or whole voxels per pixel (< 0, large ones), so that
/// a slice is about `edge` pixels wide.
int zoom(const Coord& size, int edge) {
  const int longest = std::max({size.x(), size.y(), size.z()});
  if (longest <= edge) return edge / longest;
  return -((longest + edge - 1) / edge);
}

int pixels(int voxels, int zoom) {
  return zoom > 0 ? voxels * zoom : (voxels - zoom - 1) / -zoom;
}

Picture paint(const Slice& slice, int zoom, const GrainColors& colors) {
  Picture picture(pixels(slice.width, zoom), pixels(slice.height, zoom), kBackground);
  for (int y = 0; y < picture.height; ++y) {
    for (int x = 0; x < picture.width; ++x) {
      const int i = zoom > 0 ? x / zoom : x * -zoom, j = zoom > 0 ? y / zoom : y * -zoom;
      const int32_t label = slice.labels[size_t(j) * slice.width + i];
      if (label > 0) picture.at(x, y) = colors.colorOf(label);
    }
  }
  return picture;
}

/// The mean of each block of kFinest^2 pixels.
Picture coarsened(const Picture& fine) {
  Picture coarse(std::max(1, fine.width / kFinest), std::max(1, fine.height / kFinest), kMargin);
  for (int y = 0; y < coarse.height; ++y)
    for (int x = 0; x < coarse.width; ++x)
      for (size_t channel = 0; channel < 3; ++channel) {
        int sum = 0;
        for (int j = 0; j < kFinest; ++j)
          for (int i = 0; i < kFinest; ++i)
            sum += fine.at(std::min(x * kFinest + i, fine.width - 1),
                           std::min(y * kFinest + j, fine.height - 1))[channel];
        coarse.at(x, y)[channel] = uint8_t((sum + kFinest * kFinest / 2) / (kFinest * kFinest));
      }
  return coarse;
}

/// x-y, view, x-z, y-z: where all are shown, slices that share an axis stand over one another.
std::vector<Panel> drawPanels(const Options& o, const Int32Grid& labels, const CoordBBox& box,
                              Interrupter* interrupter) {
  const GrainColors colors = grainColors(labels, interrupter);
  std::vector<Panel> panels;
  if (o.only != "view") {
    const int scale = zoom(box.extents(), o.size);
    const double voxelsPerPixel = scale > 0 ? 1.0 / scale : -scale;
    const auto add = [&](const char* caption, int fixedAxis, int right, int down) {
      panels.push_back({paint(cutSlice(labels, box, fixedAxis, right, down), scale, colors),
                        caption, voxelsPerPixel});
    };
    add("x-y", 2, 0, 1);
    add("x-z", 1, 0, 2);
    add("y-z", 0, 1, 2);
  }
  if (o.only != "slices") {
    ViewOptions options = o.view;
    options.edge = o.size * kFinest;
    const GrainView view = viewGrains(labels, box, colors, options, interrupter);
    panels.insert(panels.begin() + std::min<std::ptrdiff_t>(1, std::ptrdiff_t(panels.size())),
                  {coarsened(view.picture), "", view.voxelsPerPixel * kFinest});
  }
  return panels;
}

void copy(const Picture& from, int left, int top, Picture& to) {
  for (int y = 0; y < from.height; ++y)
    std::copy_n(&from.at(0, y), from.width, &to.at(left, top + y));
}

/// The panels in two columns, each with its name and a scale bar (if the voxel size is known)
/// below.
Picture arrange(const std::vector<Panel>& panels, const std::optional<VoxelSize>& voxelSize) {
  const size_t columns = std::min<size_t>(2, panels.size());
  const size_t rows = (panels.size() + columns - 1) / columns;
  std::vector<int> widths(columns, 0), heights(rows, 0);
  for (size_t i = 0; i < panels.size(); ++i) {
    int& width = widths[i % columns];
    int& height = heights[i / columns];
    width = std::max(width, panels[i].picture.width);
    height = std::max(height, panels[i].picture.height);
  }
  Picture whole(kGap, kGap, kMargin);
  for (const int width : widths) whole.width += width + kGap;
  for (const int height : heights) whole.height += height + kCaptionHeight + kGap;
  whole.pixels.assign(size_t(whole.width) * size_t(whole.height), kMargin);

  int top = kGap;
  for (size_t row = 0; row < rows; ++row) {
    int left = kGap;
    for (size_t i = row * columns; i < std::min(panels.size(), (row + 1) * columns); ++i) {
      const Panel& panel = panels[i];
      const int below = top + heights[row];
      // Slices end above their names; the view stands in the middle.
      const int room = heights[row] - panel.picture.height;
      copy(panel.picture, left, top + (panel.caption.empty() ? room / 2 : room), whole);
      drawText(whole, left, below + kCaptionHeight - kGlyphHeight * kCaptionScale, panel.caption,
               kInk, kCaptionScale);
      if (voxelSize) {
        const int nameWidth = textWidth(panel.caption, kCaptionScale) + kGap;
        const int right = panel.picture.width;
        const int widest = std::min(right - nameWidth, right / 2);
        // A bar that is narrower than its text ends further left.
        if (const auto bar = fitScaleBar(panel.voxelsPerPixel * voxelSize->metres, widest);
            bar && width(*bar) <= right - nameWidth)
          draw(*bar, left + right - width(*bar), below + kCaptionHeight - 1, kInk, whole);
      }
      left += widths[i % columns] + kGap;
    }
    top += heights[row] + kCaptionHeight + kGap;
  }
  return whole;
}

void run(const Options& o, const Common& common) {
  checkWritable(o.out);
  const Int32Grid::Ptr labels = loadLabels(o.input, "--grid", common.progress);
  labels->tree().voxelizeActiveTiles();
  std::optional<CoordBBox> box = storedDomain(*labels);
  if (!box) box = labels->evalActiveVoxelBoundingBox();
  if (box->empty())
    throw InvalidInput(o.input.path + ": has no labels and no domain: nothing to show");

  const std::vector<Panel> panels = drawPanels(o, *labels, *box, common.progress);
  writePng(o.out, arrange(panels, storedVoxelSize(*labels)));
  common.progress->end();
  if (common.quiet) return;
  std::cout << o.out << ": ";
  if (o.only != "view")
    std::cout << "middle slices x-y, x-z, y-z (z up), "
              << (panels[0].voxelsPerPixel <= 1
                      ? counted(std::lround(1 / panels[0].voxelsPerPixel), "pixel") + " a voxel"
                      : counted(std::lround(panels[0].voxelsPerPixel), "voxel") + " a pixel");
  if (o.only.empty()) std::cout << "; ";
  if (o.only != "slices")
    std::cout << "view from azimuth " << o.view.azimuth << ", elevation " << o.view.elevation
              << " degrees";
  std::cout << "\n";
}

}  // namespace

void addRender(Verb command, Common& common, Action& action) {
  auto o = std::make_shared<Options>();
  Verb verb = addVerb(command, common, "render", "coloured slices of labels and a shaded view",
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
