// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/volumes/volume.h"

#include <fmt/core.h>

#include "vdb_madf/files/same_file.h"
#include "vdb_madf/grids/grid_metadata.h"
#include "vdb_madf/scans/image_box.h"
#include "vdb_madf/volumes/detail/reading.h"
#include "vdb_madf/volumes/detail/volume_notes.h"

namespace vdb_madf {

namespace detail {

bool isReadAsVdb(const std::string& path, const VolumeOptions& options) {
  const bool isVdb = !options.raw && isVdbFile(path);
  if (isVdb && !options.dataset.empty())
    throw InvalidInput(path + ": a dataset is named, and this is a VDB file: name a grid");
  if (!isVdb && !options.grid.empty())
    throw InvalidInput(path + ": a grid is named, and this is no VDB file");
  return isVdb;
}

VdbReadOptions readingAlone(const openvdb::GridBase& chosen) {
  VdbReadOptions reading;
  reading.wanted = [name = chosen.getName(), type = chosen.type()](const auto& grid) {
    return grid.getName() == name && grid.type() == type;
  };
  return reading;
}

openvdb::GridBase::Ptr readGrid(const std::string& path, GridUse use, const VolumeOptions& options,
                                Interrupter* interrupter) {
  const auto chosen = chooseGrid(readVdbHeaders(path, interrupter), path, use, options.grid);
  return readVdb(path, readingAlone(*chosen), interrupter).at(0);
}

std::unique_ptr<ImageReader> checkedImage(std::unique_ptr<ImageReader> image,
                                          const VolumeOptions& options) {
  const std::string& path = image->path();
  CoordBBox box = imageBox(image->info().size);
  if (options.region.crop) box.intersect(*options.region.crop);
  for (int axis = 0; axis < 3; ++axis)
    if (options.longestSide > 0 && box.dim()[axis] > options.longestSide)
      throw InvalidInput(fmt::format(
          "{}: is {} voxels long, and at most {} can be worked with here: crop or coarsen it", path,
          box.dim()[axis], options.longestSide));
  if (options.note)
    for (const std::string& note : image->notes()) options.note(note, NoteAbout::file);
  if (options.note && image->info().isPlaced)
    options.note(path +
                     ": begins elsewhere than at 0, by its header, which is not taken over: its "
                     "first voxel is 0,0,0 (a .vdb keeps the place of a crop)",
                 NoteAbout::file);
  noteVoxelSize(path, image->info().voxelSize, options);
  if (const auto& edges = image->info().proportions) noteProportions(path, *edges, options);
  return image;
}

}  // namespace detail

void overrideFile(openvdb::GridBase& grid, const std::string& path, const VolumeOptions& options) {
  detail::noteVoxelSize(path, grid, options);
  detail::naming(path, "", [&] { detail::giveDomain(grid, path, options); });
  detail::giveVoxelSize(grid, options);
}

std::unique_ptr<ImageReader> openVolumeImage(const std::string& path,
                                             const VolumeOptions& options) {
  auto image = openImage(path, options.raw, options.dataset);
  for (const std::string& output : options.outputs)
    for (const std::string& file : image->files())
      if (isSameFile(file, output))
        throw InvalidInput(output + ": holds samples of " + path +
                           ", which the output would overwrite; choose another name");
  return detail::checkedImage(std::move(image), options);
}

}  // namespace vdb_madf
