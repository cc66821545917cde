// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <memory>
#include <string>

#include "vdb_madf/files/detail/input_file.h"
#include "vdb_madf/images/image.h"

namespace vdb_madf::detail {

/// DGtal's .vol (uint8) and .longvol (64-bit integers, read as uint32; 32-bit ones of older
/// programs are told by the size of the file), version 2 (plain) and 3 (zlib), little-endian. They
/// know no voxel size; the center is ignored: voxels are numbered from 0. Not read: version 1.
/// Source: VolReader, VolWriter, LongvolReader and LongvolWriter of DGtal.
std::unique_ptr<ImageReader> openDgtal(std::unique_ptr<InputFile> file);

/// True for the first bytes of such a file.
bool isDgtalHeader(const std::string& head);

}  // namespace vdb_madf::detail
