// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <functional>
#include <vector>

#include "vdb_madf/slabs/detail/slab_graph.h"
#include "vdb_madf/slabs/detail/slab_work.h"

namespace vdb_madf::detail {

/// Message from the root: the grain of each terminal of a slab; 0: none of the object.
constexpr char kGrainsOfTerminals[] = "grains";
/// Message from the root, if manifolds are kept: the part of a slab (readPart()).
constexpr char kGraphPart[] = "part";

/// At the root: merges the parts of the slabs, which are asked for one after the other, from the lowest
/// on, and tells the slabs.
/// @return the representative of grain g at g - 1
std::vector<Coord> mergeParts(SlabWork& work, size_t slabs,
                              const std::function<SlabGraph::Part(size_t slab)>& nextPart);

/// The same for where the terminals of all slabs lead to. Takes the messages "terminals" and
/// "contacts".
/// @param graph all is answered
/// @return the representative of grain g at g - 1
std::vector<Coord> mergeSlabs(SlabWork& work, SlabGraph graph);

void addPart(const SlabGraph::Part& part, ByteWriter& bytes);
SlabGraph::Part readPart(ByteReader bytes);

}  // namespace vdb_madf::detail
