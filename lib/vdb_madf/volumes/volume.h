// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "vdb_madf/base/voxel_size.h"
#include "vdb_madf/grids/grid_types.h"
#include "vdb_madf/grids/selection.h"
#include "vdb_madf/images/image.h"
#include "vdb_madf/images/open_image.h"
#include "vdb_madf/scans/image_object.h"
#include "vdb_madf/scans/scan_region.h"

namespace vdb_madf {

/// What a note is about: a program with options can add the one that matters.
enum class NoteAbout { file, voxelSize, labels, cylinder };

/// Any readable file, OpenVDB or an image of openImage(), as one volume. The defaults suit every
/// file that describes itself and holds one volume.
struct VolumeOptions {
  std::string grid;                    ///< name of the grid of a VDB file; empty: see GridUse
  std::string dataset;                 ///< array of a Zarr group or an HDF5 file: see openImage()
  std::optional<RawLayout> raw;        ///< of a file without a header
  std::optional<Selection> selection;  ///< object only: by value; default: see loadObject()
  GrayOptions gray;                    ///< object only: filters and thresholds of a gray image
  bool areLabels = false;              ///< labels only: also if they look like a gray image
  std::optional<VoxelSize> voxelSize;  ///< instead of the file's
  std::optional<CoordBBox> domain;     ///< of the scan, in voxels, instead of the file's
  RegionOptions region;                ///< the part of that to work on
  /// Files that the caller will write: an image that has samples in one of them is refused.
  std::vector<std::string> outputs;
  /// An image of more voxels along an axis is refused before its samples are read. 0: any.
  int longestSide = 0;
  /// A function that is told what a user should know of the volume though it is no error: one line
  /// that names it.
  std::function<void(const std::string& text, NoteAbout about)> note;
};

/// Gives a grid of the file at `path` the domain and the voxel size of the options, if they have
/// any. A voxel size that differs by more than 1 % from the file's is worth a note, and so is a
/// domain that reaches beyond the file's.
void overrideFile(openvdb::GridBase& grid, const std::string& path, const VolumeOptions& options);

/// openImage() with `raw` and `dataset` of the options. Also says its notes, and that the voxel
/// size of the options differs by more than 1 % from the file's.
/// @throw InvalidInput if it has samples in one of the outputs or is longer than allowed; IoError.
std::unique_ptr<ImageReader> openVolumeImage(const std::string& path,
                                             const VolumeOptions& options = {});

/// Opens an image, for each pass over it anew.
using ImageOpener = std::function<std::unique_ptr<ImageReader>()>;

}  // namespace vdb_madf
