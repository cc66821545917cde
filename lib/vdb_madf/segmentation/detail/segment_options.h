// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include "vdb_madf/segmentation/segment.h"

namespace vdb_madf::detail {

/// @throw InvalidInput if a number is out of its range.
void checkSegmentOptions(const SegmentOptions& options);

/// The weights that are asked for, or those of the edges. @throw InvalidInput if none fit
WeightsOfEdges resolveWeights(const std::optional<VoxelWeights>& weights,
                              const std::array<double, 3>& edges, const Coord& extent);

}  // namespace vdb_madf::detail
