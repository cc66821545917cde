// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <memory>
#include <string>

#include "vdb_madf/files/detail/input_file.h"
#include "vdb_madf/images/image.h"

namespace vdb_madf::detail {

/// What PyHST of the ESRF writes: samples in NAME.vol, their size in the text file NAME.vol.info.
/// Either of the two can be given. The type is DATA_TYPE if it is given (other programs do), else
/// told by the size of the file: float32, uint16 or uint8.
///
/// No source says the unit of voxelSize. It is taken for that of IMAGE_PIXEL_SIZE_1, which it is
/// made from: micrometers, by the comment in PyHST's parameter files ("Pixel size horizontally
/// (microns)") and by EDFTomoScan of the ESRF's tomoscan, which multiplies that key with 1e-6 m.
/// Source of the keys: the mock volumes of the ESRF's tomwer (NUM_X, NUM_Y, NUM_Z, voxelSize,
/// BYTEORDER, ValMin ...); HST_info and HST_write of pymicro (DATA_TYPE, names as of NumPy).
std::unique_ptr<ImageReader> openPyhst(std::unique_ptr<InputFile> file);

/// True for the first bytes of an .info file.
bool isPyhstHeader(const std::string& head);

}  // namespace vdb_madf::detail
