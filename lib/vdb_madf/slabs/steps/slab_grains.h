// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <functional>
#include <vector>

#include "vdb_madf/slabs/cuts/slab_part.h"
#include "vdb_madf/slabs/steps/slab_work.h"

namespace vdb_madf::detail {

/// Merges the parts of the slabs: each member those of its own, which are asked for one after the
/// other, from the lowest on; then pairs of neighboring members join what is open, pairs of pairs,
/// and so on. Leaves the pieces kGrains.
/// @return at the root the representative of grain g at g - 1
std::vector<Coord> mergeParts(SlabWork& work, const std::function<SlabPart(size_t slab)>& part);

}  // namespace vdb_madf::detail
