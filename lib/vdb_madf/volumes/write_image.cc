// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/volumes/write_image.h"

#include <algorithm>
#include <array>
#include <memory>

#include "vdb_madf/base/errors.h"
#include "vdb_madf/grids/grid_metadata.h"
#include "vdb_madf/images/open_image.h"
#include "vdb_madf/images/shared_image.h"
#include "vdb_madf/scans/image_box.h"
#include "vdb_madf/volumes/detail/sample_slabs.h"
#include "vdb_madf/volumes/detail/volume_notes.h"

namespace vdb_madf {

namespace {

/// In mm; in voxels, where there is no voxel size.
std::array<double, 3> originOf(const openvdb::GridBase& grid, const Coord& first) {
  const auto size = storedVoxelSize(grid);
  const openvdb::Vec3d place =
      size ? (size->unit() == "um" ? 1e-3 : 1.0) * grid.indexToWorld(first) : first.asVec3d();
  return {place.x(), place.y(), place.z()};
}

ImageInfo infoOf(const openvdb::GridBase& grid, const CoordBBox& box, SampleType type) {
  ImageInfo info;
  info.size = toImageSize(box.dim());
  info.type = type;
  info.voxelSize = storedVoxelSize(grid);
  return info;
}

std::unique_ptr<ImageWriter> openWriter(const std::string& path, const openvdb::GridBase& grid,
                                        const CoordBBox& box, SampleType type) {
  if (box.empty()) throw InvalidInput(path + ": there is no box to write");
  detail::requireNumbers(path, grid);
  return createImage(path, infoOf(grid, box, type), originOf(grid, box.min()));
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

/// Slabs from `begin` to before `end`: the first one with what of the box lies below all slabs, the
/// last one with what lies above them.
void writeSlabs(const std::string& path, const LabelSlabs& labels, size_t begin, size_t end,
                const CoordBBox& box, SampleType type, Interrupter* interrupter,
                ImageWriter& writer) {
  const Int32Grid nothing(0);
  const auto write = [&](const Int32Grid& grid, int first, int last) {
    writeSlices(path, grid, box, first, last, type, interrupter, writer);
  };
  if (begin == 0) write(nothing, box.min().z(), labels.cuts.front());
  const auto domain = storedDomain(*labels.about);
  for (size_t s = begin; s < end; ++s) {
    const Int32Grid::Ptr slab = labels.read(s, interrupter);
    if (domain) detail::checkWithinDomain(*slab, *domain);
    write(*slab, labels.cuts[s], labels.cuts[s + 1]);
  }
  if (end == labels.slabCount()) write(nothing, labels.cuts.back(), box.max().z() + 1);
}

}  // namespace

CoordBBox writtenBox(const openvdb::GridBase& grid) {
  if (const auto domain = storedDomain(grid)) detail::checkWithinDomain(grid, *domain);
  return boxOf(grid);
}

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
  writeSlabs(path, labels, 0, labels.slabCount(), box, type, interrupter, *writer);
  writer->finish();
}

std::unique_ptr<ImageWriter> createSharedImage(const std::string& path, const LabelSlabs& labels,
                                               const CoordBBox& box, SampleType type) {
  return openWriter(path, *labels.about, box, type);
}

void writeImagePart(const std::string& path, const SharedImage& shared, const LabelSlabs& labels,
                    size_t begin, size_t end, const CoordBBox& box, SampleType type,
                    Interrupter* interrupter) {
  if (begin >= end) return;
  const int lowest = begin == 0 ? box.min().z() : std::max(box.min().z(), labels.cuts[begin]);
  if (lowest > box.max().z()) return;
  const auto writer =
      joinImage(path, shared, infoOf(*labels.about, box, type), lowest - box.min().z());
  writeSlabs(path, labels, begin, end, box, type, interrupter, *writer);
  writer->finish();
}

}  // namespace vdb_madf
