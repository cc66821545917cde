// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/intensity/gray_scan.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "vdb_madf/base/errors.h"
#include "vdb_madf/base/limits.h"
#include "vdb_madf/grids/detail/size_and_place.h"
#include "vdb_madf/grids/grid_metadata.h"
#include "vdb_madf/scans/image_box.h"
#include "vdb_madf/segmentation/segmentation_metadata.h"
#include "vdb_madf/vdb/read_vdb.h"
#include "vdb_madf/volumes/choose_grid.h"
#include "vdb_madf/volumes/dense_volume.h"
#include "vdb_madf/volumes/detail/volume_notes.h"

namespace vdb_madf {

namespace {

SampleType typeOf(const openvdb::GridBase& grid) {
  const std::string type = grid.valueType();
  if (type == "float") return SampleType::float32;
  if (type == "double" || type == "int64") return SampleType::float64;
  return type == "int32" ? SampleType::int32 : SampleType::uint8;  // or a mask
}

/// A grid as an image of its box.
class GridReader : public ImageReader {
 public:
  GridReader(const std::string& path, openvdb::GridBase::ConstPtr grid, const CoordBBox& box)
      : grid_(std::move(grid)), box_(box) {
    path_ = path;
    files_ = {path};
    info_.size = toImageSize(box.dim());
    info_.type = typeOf(*grid_);
    info_.voxelSize = storedVoxelSize(*grid_);
    info_.format = "vdb";
  }
  void read(int first, int count, void* samples) override {
    DenseLayout layout;
    layout.type = info_.type;
    layout.box = box_;
    layout.box.min().z() += first;
    layout.box.max().z() = layout.box.min().z() + count - 1;
    copyToDense(*grid_, samples, layout);
  }

 private:
  openvdb::GridBase::ConstPtr grid_;
  CoordBBox box_;
};

GrayScan scanOfGrid(const std::string& path, const VolumeOptions& options,
                    Interrupter* interrupter) {
  if (!options.dataset.empty())
    throw InvalidInput(path + ": a dataset is named, and this is a VDB file: name a grid");
  const auto chosen =
      chooseGrid(readVdbHeaders(path, interrupter), path, GridUse::object, options.grid);
  VdbReadOptions reading;
  reading.anyVoxelShape = true;
  reading.wanted = [&chosen](const openvdb::GridBase& grid) {
    return grid.getName() == chosen->getName() && grid.type() == chosen->type();
  };
  const openvdb::GridBase::Ptr grid = readVdb(path, reading, interrupter).at(0);
  const CoordBBox box = boxOf(*grid);
  if (box.empty())
    throw InvalidInput(path + ": grid '" + grid->getName() + "' is empty and has no domain");
  if (box.dim()[box.maxExtent()] > kMaxImageSide)
    throw InvalidInput(path + ": grid '" + grid->getName() + "' is too long for a scan");
  return {std::make_unique<GridReader>(path, grid, box), box.min()};
}

}  // namespace

CoordBBox GrayScan::box() const {
  return {first, first + toCoord(image->info().size).offsetBy(-1)};
}

void placeScan(GrayScan& scan, const CoordBBox& domain) {
  if (scan.box().isInside(domain)) return;
  if (scan.first == Coord(0) && scan.box().dim() == domain.dim())
    scan.first = domain.min();
  else
    throw InvalidInput(scan.image->path() + ": has " + detail::sizeAndPlace(scan.box()) +
                       ", and the labels are those of a scan of " + detail::sizeAndPlace(domain) +
                       ": give the one that they were made of, whole or cropped as they were");
}

void placeScan(GrayScan& scan, const SampleMeasures& sample) {
  if (!sample.domainKnown)
    throw InvalidInput(scan.image->path() +
                       ": the domain of the labels is unknown, so that nothing tells whether this "
                       "is their scan: give the domain");
  placeScan(scan, sample.box);
}

namespace {

/// The domain of labels of a part of this box; none if they are of all of it, or of something else.
std::optional<Domain> partOf(const CoordBBox& box, const openvdb::GridBase& about) {
  const auto domain = storedDomain(about);
  return domain && domain->box() != box && box.isInside(domain->box()) ? domain : std::nullopt;
}

/// Whether labels lie elsewhere in the world than at their indices, as reduced and resampled ones
/// do: those count voxels of their own.
bool countsAnew(const openvdb::GridBase& about) {
  return about.transform().indexToWorld(openvdb::Vec3d(0)) != openvdb::Vec3d(0);
}

}  // namespace

std::string noteOnScan(const std::string& path, const CoordBBox& box,
                       const std::optional<VoxelSize>& voxels, const openvdb::GridBase& about) {
  std::string note;
  const auto part = partOf(box, about);
  const auto own = storedVoxelSize(about);
  const bool areSameVoxels = voxels && own && !detail::haveOtherEdges(*voxels, *own);
  if (part && !areSameVoxels && countsAnew(about))
    throw InvalidInput(path + ": has " + detail::sizeAndPlace(box) + ", and the labels, of " +
                       detail::sizeAndPlace(part->box()) +
                       ", count voxels of their own, as reduced and resampled ones do: give the "
                       "scan cropped and resampled as they were, or take the labels before that");
  if (part && part->isBox() && part->box().min() == box.min()) {
    if (!grainCount(about))
      throw InvalidInput(path + ": has " + detail::sizeAndPlace(box) + ", and the labels, of " +
                         detail::sizeAndPlace(part->box()) +
                         ", do not say where in it they were cropped: give the scan cropped as "
                         "they were");
    note =
        "is larger than the volume of the labels: taken for the scan that they were cropped from";
  }
  if (voxels && own && !areSameVoxels)
    note +=
        fmt::format("{}has voxels of {}, and the labels of {}: their indices are compared",
                    note.empty() ? "" : "; ", detail::voxelText(*voxels), detail::voxelText(*own));
  return note;
}

std::string noteOnScan(const GrayScan& scan, const openvdb::GridBase& about) {
  return noteOnScan(scan.image->path(), scan.box(), scan.image->info().voxelSize, about);
}

GrayScan openGrayScan(const std::string& path, const VolumeOptions& options,
                      Interrupter* interrupter) {
  if (!options.raw && isVdbFile(path)) return scanOfGrid(path, options, interrupter);
  if (!options.grid.empty())
    throw InvalidInput(path + ": a grid is named, and this is no VDB file");
  return {openVolumeImage(path, options), Coord(0)};
}

}  // namespace vdb_madf
