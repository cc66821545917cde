// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <memory>
#include <string>

#include "vdb_madf/images/image.h"

namespace vdb_madf::detail {

/// A dataset [z, y, x] of an HDF5 file, maybe behind axes of length 1: the one that is named, else
/// the only one; several links to one dataset count once. Integers, floats, h5py's bool; whatever
/// layout and filters the library knows. It may lie in another file, which an external link leads
/// to, or be virtual, if all the files of its parts are there. The voxel size comes from the
/// attribute element_size_um (z, y, x), which ilastik and the HDF5 plugin of ImageJ write, or from
/// NeXus' x_pixel_size, y_pixel_size (and z_pixel_size) with units, in the group of the dataset.
/// The library runs in a process of its own, as damaged files crash it. Built only where libhdf5 is
/// found.
std::unique_ptr<ImageReader> openHdf5(const std::string& path, const std::string& dataset);

/// A dataset `data` [z, y, x] in chunks, deflated, with `element_size_um` (z, y, x) where the voxel
/// size is known. The same bytes whenever it is written.
std::unique_ptr<ImageWriter> createHdf5(const std::string& path, const ImageInfo& info);

}  // namespace vdb_madf::detail
