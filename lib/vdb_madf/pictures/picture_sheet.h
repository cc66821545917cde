// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <optional>
#include <string>
#include <vector>

#include "vdb_madf/base/voxel_size.h"
#include "vdb_madf/pictures/picture.h"

namespace vdb_madf {

/// A picture of a sample with its name and its scale.
struct PicturePanel {
  Picture picture;
  std::string caption;        ///< UTF-8
  double voxelsPerPixel = 1;  ///< of their shortest edge; 0: it has no scale
  bool framed = true;         ///< a thin line around it
};

/// The panels in reading order, each with its name below and, where the voxel size is
/// known, a scale bar of a round length. There are as many columns as make the sheet small, and
/// rather wide than tall. Letters and gaps grow with the largest panel: a line is 1/24 of the
/// side of a square of its area, and 15 pixels at least. \p ink: of letters and bars.
Picture pictureSheet(const std::vector<PicturePanel>& panels,
                     const std::optional<VoxelSize>& voxelSize = std::nullopt,
                     const Rgb& background = {255, 255, 255}, const Rgb& ink = {40, 40, 40});

}  // namespace vdb_madf
