// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <optional>
#include <vector>

#include "vdb_madf/grids/domain.h"
#include "vdb_madf/leaves/leaf_index.h"

namespace vdb_madf {

/// Small holes in the object, which are filled before distances are measured (not in the paper).
///
/// A single background voxel inside a grain, as the noise of a scan leaves it, makes the distance
/// map of the whole grain hollow. So the method runs on the *body*: the object and its cavities.
/// The labels cover the object alone.
struct Cavities {
  std::vector<LeafIndex::LeafVoxels> leaves;  ///< their voxels, ascending by origin
  int64_t count = 0;
  int64_t voxels = 0;
};

/// Cavities have fewer voxels than this by default.
constexpr int64_t kFillHoles = 27;

/// What is filled if nothing is said: kFillHoles, but 0 in a domain one voxel thick, where a
/// background pixel is surrounded by four neighbors only.
int64_t defaultFillHoles(const std::optional<Domain>& domain);

/// The 6-connected components of the background, within the domain, of fewer than \p fillHoles
/// voxels. If `closed`, components that reach a face of the domain are none. Without a domain the
/// background is unbounded. All or nothing: if no background would be left in an open domain, there
/// are no cavities. Object empty or fillHoles at most 1: none. Memory is per touched leaf node, and
/// per untouched one in a component of fewer than fillHoles voxels.
/// @throw InvalidInput if these are more than kMaxLeaves; Interrupted
Cavities findCavities(const LeafIndex& object, const std::optional<Domain>& domain, bool open,
                      int64_t fillHoles, Interrupter* interrupter = nullptr);

/// The voxels of the cavities in the index of the body, ascending.
std::vector<VoxelId> cavityVoxels(const LeafIndex& body, const Cavities& cavities);

}  // namespace vdb_madf
