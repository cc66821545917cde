// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/volumes/write_image.h"

#include <array>

#include "vdb_madf/base/errors.h"
#include "vdb_madf/grids/grid_metadata.h"
#include "vdb_madf/images/open_image.h"
#include "vdb_madf/volumes/detail/sample_slabs.h"
#include "vdb_madf/volumes/image_box.h"

namespace vdb_madf {

namespace {

/// In mm; in voxels, where there is no voxel size.
std::array<double, 3> originOf(const openvdb::GridBase& grid, const Coord& first) {
  const auto size = storedVoxelSize(grid);
  const openvdb::Vec3d place =
      size ? (size->unit() == "um" ? 1e-3 : 1.0) * grid.indexToWorld(first) : first.asVec3d();
  return {place.x(), place.y(), place.z()};
}

}  // namespace

void writeImage(const std::string& path, const openvdb::GridBase& grid, const CoordBBox& box,
                SampleType type, Interrupter* interrupter) {
  if (box.empty()) throw InvalidInput(path + ": there is no box to write");
  ImageInfo info;
  info.size = toImageSize(box.dim());
  info.type = type;
  info.voxelSize = storedVoxelSize(grid);
  detail::requireNumbers(path, grid);
  const auto writer = createImage(path, info, originOf(grid, box.min()));
  detail::forEachSampleSlab(
      path, grid, box, type, interrupter,
      [&](int, int count, const void* samples) { writer->write(count, samples); });
  writer->finish();
}

}  // namespace vdb_madf
