// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <memory>

#include "vdb_madf/files/detail/input_file.h"
#include "vdb_madf/images/image.h"

namespace vdb_madf::detail {

/// NIfTI-1 in one file, .nii or .nii.gz, either byte order; a slope and intercept other than 1 and
/// 0 are applied and make the samples float32. The voxel size comes from pixdim, if the header says
/// its unit. Voxels stay where they are stored: the orientation in the patient is not applied.
/// Not read: a header apart from its data (.hdr, .img), NIfTI-2, more than three dimensions.
/// Source: nifti1.h, the official definition of the header, R. W. Cox, NIMH.
std::unique_ptr<ImageReader> openNifti(std::unique_ptr<InputFile> file);

/// True if the file, or what is compressed in it, begins like one of NIfTI-1.
bool isNifti(const InputFile& file);

}  // namespace vdb_madf::detail
