// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <vector>

#include "vdb_madf/slabs/detail/slab_graph.h"
#include "vdb_madf/slabs/detail/slab_work.h"

namespace vdb_madf::detail {

/// Message from the root: the grain of each terminal of a slab; 0: none of the object.
constexpr char kGrainsOfTerminals[] = "grains";

/// At the root: merges where the terminals of all slabs lead to, one slab after the other, and tells
/// the slabs. Takes the messages "terminals" and "contacts".
/// @param graph all is answered
/// @return the representative of grain g at g - 1
std::vector<Coord> mergeSlabs(SlabWork& work, SlabGraph graph);

}  // namespace vdb_madf::detail
