// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <openvdb/Metadata.h>

#include "vdb_madf/files/file_name.h"
#include "vdb_madf/grids/grid_metadata.h"
#include "vdb_madf/images/image.h"
#include "vdb_madf/scans/image_box.h"

namespace vdb_madf::detail {

/// Tells a grid that it came from an image: domain, voxel size and transform, `madf_source` (the
/// last part of the path, be it a file or a folder).
inline void describeImageGrid(const ImageReader& image, openvdb::GridBase& grid) {
  setDomain(grid, imageBox(image.info().size));
  setVoxelSize(grid, image.info().voxelSize);
  if (image.info().proportions) setProportions(grid, *image.info().proportions);
  grid.insertMeta(kSourceKey, openvdb::StringMetadata(lastPart(image.path())));
}

}  // namespace vdb_madf::detail
