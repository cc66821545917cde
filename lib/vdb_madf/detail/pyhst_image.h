// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <memory>
#include <string>

#include "vdb_madf/image_file.h"

namespace vdb_madf::detail {

/// What PyHST of the ESRF writes: samples in NAME.vol, their size in the text file NAME.vol.info.
/// Either can be named. The type is DATA_TYPE if it is given (other programs do), else told by the
/// size of the file: float32, uint16 or uint8. voxelSize is in micrometres.
/// Source: PyHST's manual (IMAGE_PIXEL_SIZE_1); HST_read of pymicro; tomoscan's RawVolume.
std::unique_ptr<ImageReader> openPyhst(const std::string& path);

/// True for the first bytes of an .info file.
bool isPyhstHeader(const std::string& head);

}  // namespace vdb_madf::detail
