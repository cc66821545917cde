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
  std::string caption;        ///< digits, ".", "-" and the letters m n u x y z are drawn
  double voxelsPerPixel = 1;  ///< of their shortest edge
};

/// The panels, in reading order in two columns on white, each with its name below and, where the
/// voxel size is known, a scale bar of a round length.
Picture pictureSheet(const std::vector<PicturePanel>& panels,
                     const std::optional<VoxelSize>& voxelSize = std::nullopt);

/// The mean of each block of factor x factor pixels; what is left over at the right and below is
/// cut off. At least one pixel.
Picture coarsened(const Picture& fine, int factor);

}  // namespace vdb_madf
