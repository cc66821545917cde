// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <memory>
#include <string>

#include "vdb_madf/files/detail/input_file.h"
#include "vdb_madf/images/image.h"

namespace vdb_madf::detail {

/// .txm, .txrm: scans of Zeiss Xradia and Versa microscopes, compound files with a stream per
/// slice. Integers of 8, 16 and 32 bits, float32 and float64; the voxel size is PixelSize, in
/// micrometers. Rows and slices are taken in the order in which they are stored (Bio-Formats turns
/// rows over). Projections, which a .txrm holds, are read as well, with a note.
/// Zeiss publishes no definition: these are the streams that dxchange, txrm2tiff and Bio-Formats
/// read.
std::unique_ptr<ImageReader> openTxm(std::unique_ptr<InputFile> file);

/// True for any compound file.
bool isCompoundHeader(const std::string& head);

}  // namespace vdb_madf::detail
