// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include "vdb_madf/slabs/cuts/slab_body.h"
#include "vdb_madf/slabs/cuts/slab_terminals.h"
#include "vdb_madf/slabs/steps/slab_work.h"

namespace vdb_madf::detail {

/// Keeps the terminals and balls of a slab, in a step, for makeParts().
void giveTerminals(SlabWork& work, size_t slab, const SlabTerminals& terminals,
                   const LeafIndex& index, const VoxelSet& balls);

/// The steps from the terminals to the pieces kGraphPart. The root alone finds out where those lead
/// to at which paths leave a slab; all else is done slab by slab. Takes the pieces kFlow. Fills the
/// counts of critical points and, unless they are filtered, of balls (at the root).
void makeParts(SlabWork& work, SegmentCounts& counts);

}  // namespace vdb_madf::detail
