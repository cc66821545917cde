// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include "segment_summary.h"

namespace vdb_madf::tools {

/// @throw WrongUsage for options that vdb_madf_mpi does not know
void checkRankArguments(const SegmentArguments& o);

/// What `segment` does for an output like OUT.slabs where common.ranks share the work. Each reads a part
/// of IN; all slabs are in the memory of the ranks together.
void runInRanks(const SegmentArguments& o, const Common& common);

}  // namespace vdb_madf::tools
