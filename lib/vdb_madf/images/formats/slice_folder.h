// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "vdb_madf/base/voxel_size.h"
#include "vdb_madf/files/detail/input_file.h"
#include "vdb_madf/images/image.h"

namespace vdb_madf::detail {

/// The files of a folder with one of the endings (lower case, ".tif"), ordered by name with numbers
/// compared as numbers: slice2 comes before slice10. Files that start with a dot and
/// the previews NAME_spr.bmp of SkyScan's NRecon are ignored. @throw IoError if it cannot be
/// listed.
std::vector<std::string> slicesIn(const std::string& folder,
                                  const std::vector<std::string>& endings);

/// The pixel size in a reconstruction log of the folder: the only .log file that has a line
/// "Pixel Size (um)=8.5" or "Image Pixel Size (um)=8.5", as SkyScan's NRecon writes it. NRecon
/// appends its section to the log of the scan: [Acquisition] has the "Image Pixel Size (um)" of the
/// projections, and [Reconstruction] after it the "Pixel Size (um)" of the slices. The last of
/// these lines counts. "Camera Pixel Size (um)" of [System] is that of the detector. Source: these
/// keys and sections as read by public loaders of SkyScan data (readBruker.m: both; SkyScan loader
/// of TIGRE).
std::optional<VoxelSize> voxelSizeInLog(const std::string& folder);

/// Each .png or .bmp file of the folder is a slice, of equal size and type. The voxel size comes
/// from a log; the resolution in the pictures is a printer's.
std::unique_ptr<ImageReader> openPictureFolder(const std::string& folder);
/// Opens one PNG or BMP file as a volume of one slice.
std::unique_ptr<ImageReader> openPicture(std::unique_ptr<InputFile> file);
/// The slices of such a folder. @throw IoError if it has both kinds.
std::vector<std::string> picturesIn(const std::string& folder);

}  // namespace vdb_madf::detail
