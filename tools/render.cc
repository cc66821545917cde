// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include <algorithm>
#include <cmath>
#include <iostream>
#include <memory>

#include "command.h"
#include "input.h"
#include "png_file.h"
#include "vdb_madf/errors.h"

namespace vdb_madf::tools {

namespace {

struct Options {
  InputOptions input;
  std::string out;
};

constexpr Color kBackground{18, 20, 26};
constexpr Color kMargin{255, 255, 255};
constexpr int kGap = 8;  // pixels between slices
/// Slices are shown with whole pixels per voxel (small samples) or whole voxels per pixel (large
/// ones), so that a slice is about this wide.
constexpr int kTargetEdge = 512;

/// A colour that depends on the label alone. Consecutive labels are far apart in hue (golden
/// ratio); saturation and value vary too.
Color labelColor(int32_t label) {
  constexpr double kGoldenRatio = 0.6180339887498949;
  const double hue = std::fmod(label * kGoldenRatio, 1.0) * 6;
  const double saturation = 0.45 + 0.45 * std::fmod(label * 0.7548776662466927, 1.0);
  const double value = 0.65 + 0.35 * std::fmod(label * 0.5698402909980532, 1.0);
  Color color{};
  for (int i = 0; i < 3; ++i) {
    const double k = std::fmod(hue + 4.0 - 2.0 * i + 1.0, 6.0);
    const double ramp = std::clamp(std::min(k, 4.0 - k), 0.0, 1.0);
    color[size_t(i)] = uint8_t(std::lround(255 * value * (1 - saturation * ramp)));
  }
  return color;
}

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
      slice
          .labels[size_t(p[down] - box.min()[down]) * slice.width + (p[right] - box.min()[right])] =
          *voxel;
    }
  }
  return slice;
}

/// Pixels per voxel (> 0) or voxels per pixel (< 0).
int zoom(const Coord& size) {
  const int edge = std::max({size.x(), size.y(), size.z()});
  if (edge <= kTargetEdge) return std::max(1, kTargetEdge / edge);
  return -((edge + kTargetEdge * 2 - 1) / (kTargetEdge * 2));
}

int pixels(int voxels, int zoom) {
  return zoom > 0 ? voxels * zoom : (voxels - zoom - 1) / -zoom;
}

void paint(const Slice& slice, int zoom, int left, int top, Picture& picture) {
  for (int y = 0; y < pixels(slice.height, zoom); ++y) {
    for (int x = 0; x < pixels(slice.width, zoom); ++x) {
      const int i = zoom > 0 ? x / zoom : x * -zoom, j = zoom > 0 ? y / zoom : y * -zoom;
      const int32_t label = slice.labels[size_t(j) * slice.width + i];
      picture.at(left + x, top + y) = label > 0 ? labelColor(label) : kBackground;
    }
  }
}

void run(const Options& o, const Common& common) {
  checkWritable(o.out);
  const Int32Grid::Ptr labels = loadLabels(o.input, "--grid", common.progress);
  labels->tree().voxelizeActiveTiles();
  std::optional<CoordBBox> box = domain(*labels);
  if (!box) box = labels->evalActiveVoxelBoundingBox();
  if (box->empty())
    throw InvalidInput(o.input.path + ": has no labels and no domain: nothing to show");

  // x-y, x-z, y-z.
  const Slice slices[3] = {cutSlice(*labels, *box, 2, 0, 1), cutSlice(*labels, *box, 1, 0, 2),
                           cutSlice(*labels, *box, 0, 1, 2)};
  const int scale = zoom(box->extents());
  int width = -kGap, height = 0;
  for (const Slice& slice : slices) {
    width += pixels(slice.width, scale) + kGap;
    height = std::max(height, pixels(slice.height, scale));
  }
  Picture picture(width, height, kMargin);
  int left = 0;
  for (const Slice& slice : slices) {
    paint(slice, scale, left, 0, picture);
    left += pixels(slice.width, scale) + kGap;
  }
  writePng(o.out, picture);
  common.progress->end();
  if (!common.quiet)
    std::cout << o.out << ": middle slices x-y, x-z, y-z; "
              << (scale > 0 ? std::to_string(scale) + " pixels a voxel"
                            : std::to_string(-scale) + " voxels a pixel")
              << "\n";
}

}  // namespace

void addRender(CLI::App& app, Common& common, Action& action) {
  auto o = std::make_shared<Options>();
  CLI::App* verb = addVerb(app, common, "render", "coloured slices of labels",
                           "vdb_madf render grains.vdb grains.png");
  verb->add_option("LABELS", o->input.path, "labels: VDB or integer image")->required();
  verb->add_option("OUT.png", o->out, "the three middle slices, side by side")->required();
  verb->add_option("--grid", o->input.gridName, "VDB input: the grid to take")->type_name("NAME");
  o->input.addRaw(*verb);
  verb->callback([o, &common, &action] {
    if (!hasPngEnding(o->out)) throw WrongUsage(o->out + ": the output's ending must be .png");
    o->input.outputs = {o->out};
    o->input.parse();
    action = [o, &common] { run(*o, common); };
  });
}

}  // namespace vdb_madf::tools
