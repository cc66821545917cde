// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstdint>
#include <vector>

#include "vdb_madf/leaves/detail/label_masks.h"
#include "vdb_madf/leaves/leaf_index.h"
#include "vdb_madf/method/tidy.h"

namespace vdb_madf::detail {

/// Stands for the anchor of a grain that has no voxel in the index.
constexpr VoxelId kNoAnchor = ~VoxelId(0);

/// tidy() of one round or more, with the masks of the labels. Returns whether each grain is
/// connected then.
bool tidyMasks(const LeafIndex& index, int rounds, LabelMasks& masks, GrainLabels& grains,
               Interrupter* interrupter);

/// The first part of tidy(): rounds of smoothing. \p anchor: of grain g at g - 1. A round only
/// looks at leaves where something may change: the first at all, another at those that see a change
/// of the round before.
void smoothInterfaces(const LeafIndex& index, int rounds, const std::vector<VoxelId>& anchor,
                      LabelMasks& masks, GrainLabels& grains, Interrupter* interrupter);

/// A voxel that may become the anchor of its grain: the nearest to the representative does, then
/// that of the smaller position.
struct AnchorCandidate {
  int64_t away = -1;  ///< squared distance from the representative; -1: none
  Coord position;

  void improve(const AnchorCandidate& other);
};

/// The best voxels for the grains `wanted` (g at g - 1), in their order.
std::vector<AnchorCandidate> anchorCandidates(const LeafIndex& index, const GrainLabels& grains,
                                              const std::vector<uint32_t>& wanted,
                                              Interrupter* interrupter);

}  // namespace vdb_madf::detail
