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

/// Adds to the summary of a segmentation what slabs took: `slab_count`, `exchanges`, and of each stage
/// `seconds` and `message_bytes`.
void addSlabCosts(const SlabObject& object, const SlabSegmentation& s, Json& json);

/// The file of a slab, of so many.
void writeSlab(const std::string& path, const SlabGrids& grids, size_t slab, size_t count,
               Progress* progress);

/// What index.json says of slabs, from what is said of the segmentation.
Json slabIndex(const SegmentArguments& o, const SlabObject& object, const Json& summary);

/// Works in OUT.slabs.part, and in the scratch folder, which stay for --resume if the work is cut off
/// after the object was read; at the end OUT.slabs appears whole.
void runInSlabs(const SegmentArguments& o, const Common& common);

}  // namespace vdb_madf::tools
