// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <optional>
#include <string>
#include <vector>

#include "command.h"
#include "vdb_madf/grids/grid_types.h"
#include "vdb_madf/grids/label_slabs.h"
#include "vdb_madf/images/image.h"

namespace vdb_madf::tools {

/// @throw WrongUsage unless volumes are written with such an ending
void checkVolumeEnding(const std::string& path);

/// Writes a grid over its domain as an image, and says what became of it: a RAW file does not tell
/// its size and type itself. Without a domain it is the box of the active voxels.
/// @param type default: the smallest that surely holds the grid's values
/// @param source whose grid it is, for the message that there is nothing to write
void writeGridAsImage(const std::string& path, const openvdb::GridBase& grid,
                      const std::optional<SampleType>& type, const std::string& source,
                      const Common& common);

/// Writes labels in slabs as an image, one by one; reads them twice, where the box or the type
/// follows from them. Where there are common.team, each writes some of them.
/// @throw InvalidInput if several processes cannot write such a file
void writeSlabsAsImage(const std::string& path, const LabelSlabs& labels,
                       const std::optional<SampleType>& type, const std::string& source,
                       const Common& common);

/// Notes, of which empty ones are none.
void note(const std::vector<std::string>& notes, const Common& common);

/// Says what samples an image has, unless the user wants to hear nothing.
void reportImage(const std::string& path, const std::string& what, const Coord& size,
                 SampleType type, const Common& common);

}  // namespace vdb_madf::tools
