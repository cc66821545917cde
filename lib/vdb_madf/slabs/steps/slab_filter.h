// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include "vdb_madf/slabs/steps/slab_completion.h"
#include "vdb_madf/slabs/steps/slab_map.h"

namespace vdb_madf::detail {

/// The filter by gamma in slabs: leaves the completed map of the kept balls of each slab in
/// `completion`. Sets the counts of balls, at the root.
void filterInSlabs(SlabWork& work, const SlabOffers& offers, SlabCompletion& completion,
                   SegmentCounts& counts);

}  // namespace vdb_madf::detail
