// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <functional>
#include <vector>

#include "vdb_madf/slabs/detail/slab_part.h"
#include "vdb_madf/slabs/detail/slab_work.h"

namespace vdb_madf::detail {

/// The grain of each terminal of a slab, a piece of it; 0: none of the object.
constexpr char kGrainsOfTerminals[] = "grains";

/// Merges the parts of the slabs: each rank those of its own, which are asked for one after the other, from
/// the lowest on; then pairs of neighboring ranks join what is open, pairs of pairs, and so on. Leaves the
/// pieces kGrainsOfTerminals.
/// @return at the root the representative of grain g at g - 1
std::vector<Coord> mergeParts(SlabWork& work, const std::function<SlabPart(size_t slab)>& part);

}  // namespace vdb_madf::detail
