// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <string>

#include "segment_summary.h"

namespace vdb_madf::tools {

/// What `segment` does for an output like OUT.slabs: a folder of parts, from slabs that need not fit in
/// memory together.
bool hasSlabsEnding(const std::string& path);
/// "OUT.slabs" of "OUT.slabs/", as shells complete it; other paths as they are.
std::string withoutSlash(std::string path);

/// @throw WrongUsage for options that slabs do not know
void checkSlabArguments(const SegmentArguments& o);

/// The file of a slab, of so many.
void writeSlab(const std::string& path, const SlabGrids& grids, size_t slab, size_t count,
               Progress* progress);

/// Works in OUT.slabs.part, and in scratch. Both stay for --resume, by any number of members, if the work is
/// cut off after the object was read; at the end OUT.slabs appears whole.
/// Where there are common.team, these share the work: see WorkPlace.
void runInSlabs(const SegmentArguments& o, const Common& common);

}  // namespace vdb_madf::tools
