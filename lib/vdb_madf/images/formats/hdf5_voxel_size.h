// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <hdf5.h>

#include <optional>
#include <string>
#include <vector>

#include "vdb_madf/base/voxel_size.h"

namespace vdb_madf::detail {

/// The attribute element_size_um (z, y, x) of a dataset, else NeXus' x_pixel_size, y_pixel_size
/// and, if it is there, z_pixel_size with their attribute `units`, in a group of the dataset: of
/// the one that it lies in, by any of its names. Nothing without a unit.
/// @throw IoError if they cannot be read or are no plausible lengths
std::optional<VoxelSize> hdf5VoxelSize(const std::string& path, hid_t file, hid_t dataset,
                                       const std::vector<std::string>& names);

/// The labels of its dimensions, empty where one has none; nothing without any.
std::vector<std::string> hdf5AxisNames(hid_t dataset);

}  // namespace vdb_madf::detail
