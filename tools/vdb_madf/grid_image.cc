// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "grid_image.h"

#include <iostream>

#include "outputs.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/files/file_ending.h"
#include "vdb_madf/grids/grid_metadata.h"
#include "vdb_madf/images/open_image.h"
#include "vdb_madf/volumes/label_type.h"
#include "vdb_madf/volumes/write_image.h"

namespace vdb_madf::tools {

namespace {

/// Programs that look at TIFF take signed samples for something else than labels, if they take them
/// at all.
SampleType naturalType(const openvdb::GridBase& grid, const std::string& path) {
  if (grid.isType<Int32Grid>() && hasTiffEnding(path))
    return labelType(static_cast<const Int32Grid&>(grid));
  const std::string type = grid.valueType();
  if (grid.isType<MaskGrid>() || type == "bool") return SampleType::uint8;
  if (type == "float") return SampleType::float32;
  if (type == "double") return SampleType::float64;
  return SampleType::int32;
}

}  // namespace

void checkVolumeEnding(const std::string& path) {
  if (path == "-") throw WrongUsage("-: say in which format: raw:-, npy:- or nrrd:-");
  if (!hasVdbEnding(path) && !isImageEnding(path))
    throw WrongUsage(path +
                     ": the ending must be .vdb, .tif, .raw, .mhd, .mha, .nrrd, .npy or .h5");
}

void writeGridAsImage(const std::string& path, const openvdb::GridBase& grid,
                      const std::optional<SampleType>& type, const std::string& source,
                      const Common& common) {
  const CoordBBox box = boxOf(grid);
  if (!storedDomain(grid)) {
    if (grid.activeVoxelCount() == 0)
      throw InvalidInput(source + ": grid '" + grid.getName() +
                         "' is empty and has no domain: there is nothing to write; give --domain");
    if (!common.quiet)
      std::cout << path
                << ": no known domain, so the active bounding box is written; its origin is "
                << box.min() << "\n";
  }
  const SampleType chosen = type.value_or(naturalType(grid, path));
  writeImage(path, grid, box, chosen, common.progress);
  noteLostEdges(path, hasCubicVoxels(grid), storedVoxelSize(grid), common);
  reportImage(path, "grid '" + grid.getName() + "'", box.dim(), chosen, common);
}

void noteLostEdges(const std::string& path, bool areCubes, const std::optional<VoxelSize>& size,
                   const Common& common) {
  const std::string ending = fileEnding(path);
  if (areCubes || (size && ending != ".raw" && ending != ".npy")) return;
  common.progress->note(path +
                        ": does not say that its voxels are no cubes: give their edges again "
                        "where it is read (--voxel-size)");
}

void reportImage(const std::string& path, const std::string& what, const Coord& size,
                 SampleType type, const Common& common) {
  common.progress->end();
  if (common.quiet) return;
  std::cout << path << ": " << what << ", " << size.x() << "x" << size.y() << "x" << size.z()
            << " voxels of type " << sampleTypeName(type) << "\n";
}

}  // namespace vdb_madf::tools
