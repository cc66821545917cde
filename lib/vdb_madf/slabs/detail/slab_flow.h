// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include "vdb_madf/slabs/detail/slab_graph.h"
#include "vdb_madf/slabs/detail/slab_work.h"

namespace vdb_madf::detail {

/// The method up to the graph: distance, power map and flow, slab after slab. Leaves the pieces "flow"
/// (as Flow::manifold, between terminals). Fills the counts up to the critical points, boundary and
/// weights.
/// @throw as segmentSlabs()
SlabGraph flowInSlabs(SlabWork& work, SlabSegmentation& result);

}  // namespace vdb_madf::detail
