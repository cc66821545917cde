// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/pictures/label_panels.h"

#include <algorithm>
#include <utility>

#include "vdb_madf/labels/grain_colors.h"
#include "vdb_madf/pictures/label_slices.h"

namespace vdb_madf {

namespace {

/// The view is drawn with so many rays along each edge of a pixel.
constexpr int kFinest = 2;

}  // namespace

std::vector<PicturePanel> labelPanels(const Int32Grid& labels, const CoordBBox& box,
                                      const PanelOptions& options, Interrupter* interrupter) {
  const GrainColors colors = grainColors(labels, interrupter);
  std::vector<PicturePanel> panels;
  if (options.slices) {
    LabelSlices slices = middleSlices(labels, box, colors, options.edge);
    const char* const names[] = {"x-y", "x-z", "y-z"};
    for (size_t i = 0; i < slices.pictures.size(); ++i)
      panels.push_back({std::move(slices.pictures[i]), names[i], slices.voxelsPerPixel});
  }
  if (options.view) {
    ViewOptions direction = options.direction;
    direction.edge = options.edge * kFinest;
    const GrainView view = viewGrains(labels, box, colors, direction, interrupter);
    panels.insert(panels.begin() + std::min<std::ptrdiff_t>(1, std::ptrdiff_t(panels.size())),
                  {coarsened(view.picture, kFinest), "", view.voxelsPerPixel * kFinest});
  }
  return panels;
}

}  // namespace vdb_madf
