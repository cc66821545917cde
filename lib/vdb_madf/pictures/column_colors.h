// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <string>

#include "vdb_madf/labels/grain_colors.h"
#include "vdb_madf/measure/measure.h"
#include "vdb_madf/pictures/picture_sheet.h"

namespace vdb_madf {

/// Grains by a number of each, from dark blue over green to yellow; gray where it is not known.
struct ColumnColors {
  GrainColors colors;
  std::string title;  ///< the column's name in tables, with its unit
  /// What the scale spans, in that unit: all but a hundredth at each end; of `stability` 0 to 1.
  double low = 0, high = 1;
};

/// @param column of columns.h, with its unit or without
/// @throw InvalidInput that names all columns if there is none of this name
ColumnColors columnColors(const Measurements& measured, const std::string& column);

/// The scale with its numbers, for a sheet of pictures with this edge, as a panel.
PicturePanel colorScalePanel(const ColumnColors& colors, int edge, const Rgb& background);

}  // namespace vdb_madf
