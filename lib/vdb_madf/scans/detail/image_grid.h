// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <openvdb/Metadata.h>

#include <filesystem>
#include <string>

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
  const std::filesystem::path path(image.path());
  const std::string name = (path.has_filename() ? path : path.parent_path()).filename().string();
  grid.insertMeta(kSourceKey, openvdb::StringMetadata(name));
}

}  // namespace vdb_madf::detail
