// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <vector>

#include "vdb_madf/grids/grid_types.h"
#include "vdb_madf/pictures/grain_view.h"
#include "vdb_madf/pictures/picture_sheet.h"

namespace vdb_madf {

struct PanelOptions {
  bool slices = true, view = true;
  int edge = 512;         ///< of each panel, about, in pixels
  ViewOptions direction;  ///< of the view; its edge is not used
};

/// Labels for pictureSheet(): x-y, view, x-z, y-z. Where all are shown, slices that share an axis
/// stand over one another.
/// @param box not empty
/// @throw as middleSlices() and viewGrains()
std::vector<PicturePanel> labelPanels(const Int32Grid& labels, const CoordBBox& box,
                                      const PanelOptions& options,
                                      Interrupter* interrupter = nullptr);

}  // namespace vdb_madf
