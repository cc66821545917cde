// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <optional>
#include <vector>

#include "vdb_madf/grids/grid_types.h"
#include "vdb_madf/grids/label_slabs.h"
#include "vdb_madf/labels/grain_colors.h"
#include "vdb_madf/pictures/grain_view.h"
#include "vdb_madf/pictures/label_slices.h"
#include "vdb_madf/pictures/picture_sheet.h"

namespace vdb_madf {

/// Which panels there are, and what they show.
struct PanelOptions {
  bool slices = true, view = true;
  int edge = 512;                       ///< of each panel, about, in pixels
  ViewOptions direction;                ///< of the view; its edge and box are not used
  bool axes = true;                     ///< around the view: box and names of axes
  std::vector<SlicePlane> planes = {};  ///< none: the middle ones
  std::vector<GrayPlane> gray = {};     ///< under each of the planes: as in SliceOptions
  /// Grains that are shown: in slices the others are pale, in the view they are left out. None:
  /// all.
  std::vector<int32_t> select = {};
  CoordBBox frame = {};                              ///< what the view shows; empty: all of the box
  std::optional<GrainColors> colors = std::nullopt;  ///< none: those of all labels
  /// Shows only the voxels of grains that share a face with another grain.
  bool interfaces = false;
};

/// Labels for pictureSheet(): the slices, with where they are, and the view, with the size of the
/// box; the view is the second of four. Colors do not depend on what is shown.
/// @param box not empty
/// @throw as selectGrains(), labelSlices() and viewGrains()
std::vector<PicturePanel> labelPanels(const Int32Grid& labels, const CoordBBox& box,
                                      const PanelOptions& options,
                                      Interrupter* interrupter = nullptr);

/// The same pictures of labels in slabs, which need not fit in memory together. All slabs are read
/// once, for the colors, and those again that are seen in the view. In memory are two slabs, the
/// leaf nodes that the planes cut, those that are seen, and for the view a bit for each voxel of
/// the other leaf nodes.
std::vector<PicturePanel> labelPanels(const LabelSlabs& labels, const CoordBBox& box,
                                      const PanelOptions& options,
                                      Interrupter* interrupter = nullptr);

}  // namespace vdb_madf
