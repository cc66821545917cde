// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <memory>
#include <string>

#include "vdb_madf/images/image.h"

namespace vdb_madf::detail {

/// A Zarr array [z, y, x] of version 2 or 3, or an array of a group: the one that is named (or of
/// the group that is named), else the first scale of an OME-Zarr image, else the only volume. The
/// voxel size comes from the axes and scales of OME-Zarr 0.4, 0.5 or 0.6, if the axes have units. A
/// layer of chunks is kept decoded if it is not too large. Not read: several channels or times,
/// other codecs than those of zarr_array.h.
/// Source: Zarr storage specification version 2, core specification version 3; OME-NGFF 0.4, 0.5
/// and 0.6 (multiscales).
std::unique_ptr<ImageReader> openZarr(const std::string& path, const std::string& dataset);

/// True for a folder that is a Zarr array or group.
bool isZarrFolder(const std::string& path);

}  // namespace vdb_madf::detail
