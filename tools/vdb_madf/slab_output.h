// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <string>

#include "segment_summary.h"

namespace vdb_madf::tools {

// What `segment` does for an output like OUT.slabs: a folder of parts, from slabs that need not fit
// in memory together.

/// Checks the options of an output in slabs. @throw WrongUsage for what slabs do not know
void checkSlabArguments(const SegmentArguments& o);

/// Says, for --dry-run, how many slabs there would be, and what memory and scratch they would take.
/// Reads the object.
void estimateSlabs(const SegmentArguments& o, const Common& common);

/// Works in OUT.slabs.part, and in scratch. Both stay for --resume, by any number of members, if
/// the work is cut off after the object was read; at the end OUT.slabs appears whole.
/// Where there are common.team, these share the work: see WorkPlace.
void runInSlabs(const SegmentArguments& o, const Common& common);

}  // namespace vdb_madf::tools
