// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include "vdb_madf/slabs/steps/slab_work.h"

namespace vdb_madf::detail {

/// The method up to the graph: distance, power map and flow, slab after slab. Leaves the pieces
/// "flow" (as Flow::manifold, between terminals) and kGraphPart, unless there is no object. Fills
/// the counts up to the critical points, boundary and weights.
/// @throw as segmentSlabs()
void flowInSlabs(SlabWork& work, SlabSegmentation& result);

}  // namespace vdb_madf::detail
