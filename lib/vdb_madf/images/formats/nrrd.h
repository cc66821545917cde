// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <memory>
#include <string>

#include "vdb_madf/files/detail/input_file.h"
#include "vdb_madf/images/image.h"

namespace vdb_madf::detail {

/// NRRD with the data in the same file or in one other, encoding raw or gzip. The voxel size comes
/// from `spacings` with `units`, or `space directions` with `space units`; without units there is
/// none. A rotated frame is fine, a sheared one is an error.
/// Not read: text and bzip2 encodings, other than three dimensions, data spread over several files.
/// Source: "Definition of NRRD File Format", teem.sourceforge.net/nrrd/format.html.
std::unique_ptr<ImageReader> openNrrd(std::unique_ptr<InputFile> file);
/// Writes one file, encoding raw. The spacing is written in millimeters, which is what ITK takes it
/// for.
std::unique_ptr<ImageWriter> createNrrd(const std::string& path, const ImageInfo& info,
                                        const std::array<double, 3>& origin);

}  // namespace vdb_madf::detail
