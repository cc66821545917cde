// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstdint>
#include <vector>

#include "vdb_madf/method/manifold_graph.h"
#include "vdb_madf/method/merge.h"

namespace vdb_madf {

/// Two grains that touch, numbered from 0, and the voxel faces between them.
struct GrainContact {
  uint32_t first = 0, second = 0;
  int64_t faces = 0;
};

/// Joins grains of fewer than `least` voxels to what they touch (not in the paper): again and again
/// the smallest one, of equal ones that of the smaller number, becomes part of the neighbor with
/// which it shares most faces, of equal ones that of the smaller number. The neighbor keeps its
/// number; voxels and contacts are added. A grain that touches none stays.
///
/// Time and memory are about those of the contacts.
/// @param voxels of each grain
/// @param contacts in any order; those of one pair are added
/// @return the grain that each one is part of: itself, unless it has joined another
std::vector<uint32_t> joinSmall(std::vector<int64_t> voxels,
                                const std::vector<GrainContact>& contacts, int64_t least);

/// A merging without its grains of fewer than `least` voxels of the object: joinSmall() for its
/// grains, whose contacts are the faces between their manifolds. Grains are numbered as by merge().
Merging joinSmallGrains(const ManifoldGraph& graph, const Merging& merging, int64_t least);

}  // namespace vdb_madf
