// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <memory>
#include <string>
#include <vector>

#include "vdb_madf/files/detail/input_file.h"
#include "vdb_madf/images/image.h"

namespace vdb_madf::detail {

// Gray TIFF of 1, 8, 16 or 32 bits, signed, unsigned or float, and float64; strips or tiles; either
// byte order; uncompressed, LZW, Deflate, PackBits, CCITT, Zstandard.
//
// Samples are returned as stored, in stored row order and of any number of bits: a palette or "0 is
// white" changes how a picture looks, not the values of a measurement. (tifffile and ImageJ's wider
// samples do the same.) Of files where 0 is white there is a note: viewers show them inverted.
// Pages marked as thumbnails or transparency masks are ignored.

/// Each page is a slice; or, as ImageJ writes stacks of 4 GB and more and tifffile with `truncate`,
/// one page is followed by the others' samples.
std::unique_ptr<ImageReader> openTiff(std::unique_ptr<InputFile> file);

/// Each .tif or .tiff file of the folder is a slice, ordered by name with numbers compared as
/// numbers: slice2 comes before slice10. Files that start with a dot are ignored.
std::unique_ptr<ImageReader> openTiffFolder(const std::string& path);
/// The slices of such a folder, in order; empty if there are none.
std::vector<std::string> tiffFilesIn(const std::string& folder);

/// Multi-page, Deflate; BigTIFF if the samples could take 4 GB. The voxel size is written the way
/// ImageJ does (resolution, and the unit and slice spacing in the description).
std::unique_ptr<ImageWriter> createTiff(const std::string& path, const ImageInfo& info);

}  // namespace vdb_madf::detail
