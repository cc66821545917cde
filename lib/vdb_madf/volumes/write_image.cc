// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/volumes/write_image.h"

#include <algorithm>
#include <array>
#include <memory>

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

std::unique_ptr<ImageWriter> openWriter(const std::string& path, const openvdb::GridBase& grid,
                                        const CoordBBox& box, SampleType type) {
  if (box.empty()) throw InvalidInput(path + ": there is no box to write");
  ImageInfo info;
  info.size = toImageSize(box.dim());
  info.type = type;
  info.voxelSize = storedVoxelSize(grid);
  detail::requireNumbers(path, grid);
  return createImage(path, info, originOf(grid, box.min()));
}

/// Slices of a box whose labels are all in `grid`.
void writeSlices(const std::string& path, const Int32Grid& grid, CoordBBox box, int begin, int end,
                 SampleType type, Interrupter* interrupter, ImageWriter& writer) {
  box.min().z() = std::max(box.min().z(), begin);
  box.max().z() = std::min(box.max().z(), end - 1);
  if (box.empty()) return;
  detail::forEachSampleSlab(
      path, grid, box, type, interrupter,
      [&](int, int count, const void* samples) { writer.write(count, samples); });
}

}  // namespace

void writeImage(const std::string& path, const openvdb::GridBase& grid, const CoordBBox& box,
                SampleType type, Interrupter* interrupter) {
  const auto writer = openWriter(path, grid, box, type);
  detail::forEachSampleSlab(
      path, grid, box, type, interrupter,
      [&](int, int count, const void* samples) { writer->write(count, samples); });
  writer->finish();
}

void writeImage(const std::string& path, const LabelSlabs& labels, const CoordBBox& box,
                SampleType type, Interrupter* interrupter) {
  const auto writer = openWriter(path, *labels.about, box, type);
  const Int32Grid nothing(0);
  const auto write = [&](const Int32Grid& grid, int begin, int end) {
    writeSlices(path, grid, box, begin, end, type, interrupter, *writer);
  };
  write(nothing, box.min().z(), labels.cuts.front());
  for (size_t s = 0; s < labels.slabCount(); ++s)
    write(*labels.read(s, interrupter), labels.cuts[s], labels.cuts[s + 1]);
  write(nothing, labels.cuts.back(), box.max().z() + 1);
  writer->finish();
}

}  // namespace vdb_madf
