// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <memory>
#include <string>

#include "vdb_madf/files/detail/input_file.h"
#include "vdb_madf/images/image.h"

namespace vdb_madf::detail {

/// Scanco's .isq: int16, little-endian, as stored (not divided by the mu scaling). The voxel size
/// is the field of view over the voxels, which the header has in whole micrometers. Not read:
/// projections (.rad), .aim. Source: layout of the header as in itk::ScancoImageIO (ITKIOScanco)
/// and BoneJ's ISQReader.
std::unique_ptr<ImageReader> openIsq(std::unique_ptr<InputFile> file);

/// True for the first bytes of such a file.
bool isIsqHeader(const std::string& head);

}  // namespace vdb_madf::detail
