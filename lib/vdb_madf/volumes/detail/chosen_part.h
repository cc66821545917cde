// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <optional>
#include <string>

#include "vdb_madf/scans/image_object.h"
#include "vdb_madf/volumes/volume.h"

namespace vdb_madf::detail {

/// The part of a grid of the file at `path` that the options choose, if they choose one: the grid
/// has it as its domain then. Says what was fitted, and that a part of what is closed is closed.
/// @throw InvalidInput that names the file if there is none, a mask does not cover the scan, or a
///   radius cannot be fitted; as loadObject() for a mask.
std::optional<ScanPart> partOf(openvdb::GridBase& grid, const std::string& path,
                               const VolumeOptions& options, Interrupter* interrupter);

/// The part of an image that the options choose, if they choose one. Says and throws as partOf().
std::optional<ScanPart> partOfImage(const ImageOpener& open, const VolumeOptions& options,
                                    Interrupter* interrupter);

}  // namespace vdb_madf::detail
