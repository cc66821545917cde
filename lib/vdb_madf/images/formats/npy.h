// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <memory>
#include <string>

#include "vdb_madf/files/detail/input_file.h"
#include "vdb_madf/images/image.h"

namespace vdb_madf::detail {

/// NumPy's .npy of an array [z, y, x] in C order, format versions 1 to 3, any integers, bool and
/// floats of 32 or 64 bits, either byte order. It knows no voxel size.
/// Not read: Fortran order (its slices lie scattered over the file), other than three dimensions.
/// Source: numpy.lib.format in NumPy's documentation.
std::unique_ptr<ImageReader> openNpy(std::unique_ptr<InputFile> file);
/// Version 1, C order, little-endian: np.load(path)[z, y, x].
std::unique_ptr<ImageWriter> createNpy(const std::string& path, const ImageInfo& info);

/// True for the first bytes of an .npy file.
bool isNpyHeader(const std::string& head);

}  // namespace vdb_madf::detail
