// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <memory>
#include <string>

#include "vdb_madf/images/image.h"

namespace vdb_madf::detail {

/// A Zarr version 2 array [z, y, x], or an array of a group: the one that is named, else the first
/// scale of an OME-Zarr image, else the only volume. The voxel size comes from OME-Zarr's axes and
/// scales, if the axes have units. A layer of chunks is kept decoded if it is not too large.
/// Not read: version 3, several channels or times, other compressors than blosc, zlib and gzip.
/// Source: Zarr storage specification version 2; OME-NGFF 0.4 (multiscales).
std::unique_ptr<ImageReader> openZarr(const std::string& path, const std::string& dataset);

/// True for a folder that is a Zarr array or group, of version 3, too.
bool isZarrFolder(const std::string& path);

}  // namespace vdb_madf::detail
