// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include "command.h"
#include "segment_summary.h"

namespace vdb_madf::tools {

/// True if slabs can do what was asked for, as far as options tell.
bool couldBeInSlabs(const SegmentArguments& o);

/// True if the input is an image that is too long for a whole, or whose mask, a bit for each voxel,
/// may take half of the memory that is allowed.
bool isSurelyForSlabs(const SegmentArguments& o);

/// What is said of an object that does not fit, with what to do about it.
InvalidInput withSlabsAdvice(const SegmentArguments& o, const InvalidInput& error);

/// Segments into OUT.slabs, and makes the one file of it that was asked for. The slabs stay if the
/// file cannot be made of them.
void runAutoSlabs(const SegmentArguments& o, const Common& common);

}  // namespace vdb_madf::tools
