// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <optional>
#include <vector>

#include "vdb_madf/slabs/slab_builder.h"

namespace vdb_madf {

/// An object that several ranks have read, each a part of its layers of leaf nodes, cut into slabs of
/// about as many voxels each, as many as there are ranks or more, and dealt to these. All call it.
/// Nothing of it is in the memory of a rank but what was sent to it, which is in its scratch.
/// @param leaves those that this rank has read; a leaf is read by one rank
/// @param limits of a slab; voxels as in SlabLimits
/// @param reach how far beyond its slabs a rank has to know the object, voxels
/// @return what segmentSlabs() takes; the cuts cover the domain, if there is one, and the object
SlabObject dealSlabs(std::vector<LeafIndex::LeafVoxels> leaves, const SlabLimits& limits,
                     int64_t reach, const std::optional<Domain>& domain, MaskGrid::ConstPtr about,
                     Ranks& ranks, Scratch& scratch);

}  // namespace vdb_madf
