// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include "vdb_madf/method/merge.h"
#include "vdb_madf/method/tidy.h"

namespace vdb_madf {

/// Other grains from a stored `manifold` grid (segment with keepManifold) and the graph on it:
/// equal to a fresh segmentation with these merge options and rounds of tidying, without
/// distances and power map.
/// @return the grid `grain`, with the manifold grid's metadata (less the graph) brought up to date.
/// @throw InvalidInput if the grid carries no graph or does not fit it; Interrupted.
Int32Grid::Ptr remerge(const Int32Grid& manifold, const MergeOptions& options = {},
                       int tidyRounds = kTidy, Interrupter* interrupter = nullptr);

/// Makes grains by a merging of one's own (merge.h: mergeClasses()) of the graph stored on the grid
/// (graph_metadata.h: storedGraph()). In the metadata `madf_merge` is "own"; theta, adjacency and
/// delta are gone. If the manifolds of a grain do not touch, give 0 rounds: tidying gives what is
/// not connected with the representative to the grains around it.
/// @throw InvalidInput also if the merging does not fit the graph: a node too many or too few, a
///   manifold with voxels in no grain, a grain without voxels or with a foreign representative.
Int32Grid::Ptr applyMerging(const Int32Grid& manifold, const Merging& merging,
                            int tidyRounds = kTidy, Interrupter* interrupter = nullptr);

}  // namespace vdb_madf
