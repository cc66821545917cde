// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <string>
#include <vector>

#include "vdb_madf/segmentation/segment.h"

// What holds for every segmentation, whatever the object: checked without an oracle, so on real
// data too. Each returns an empty string, or a description of the first violation.

namespace vdb_madf::test {

/// The active voxels of `labels` are the object; their values are 1..count, each in use; all else
/// is 0.
std::string labelsCoverObject(const MaskGrid& object, const Int32Grid& labels, int64_t count);

/// D >= 1 on the object, and sqrt(D) differs by at most the edge sqrt(w) between 6-neighbours, w
/// the weight of their axis.
std::string distanceIsLipschitz(const MaskGrid& object, const Int32Grid& distanceSquared,
                                const VoxelWeights& weights = {});

/// power <= -D without a filter (the ball at p itself is a candidate).
std::string powerIsAtMostMinusDistance(const Int32Grid& distanceSquared, const Int32Grid& power);

/// H = -power is at most D of the critical point that the voxel flows to; equal only there.
std::string heightsClimb(const Int32Grid& power, const Int32Grid& manifold,
                         const ManifoldGraph& graph);

/// Nodes are in lexicographic order; node i lies in manifold i + 1, has its number of voxels and
/// power -D.
std::string nodesMatchManifolds(const ManifoldGraph& graph, const Int32Grid& manifold,
                                const Int32Grid& power);

/// Edges are sorted, first < second, and those of a recount from the grids, with the same contact
/// faces and saddle heights; h <= min(D, D); each edge has a contact face.
std::string edgesMatchManifolds(const ManifoldGraph& graph, const Int32Grid& manifold,
                                const Int32Grid& power);

/// No two voxels of one manifold have different labels.
std::string grainsAreUnionsOfManifolds(const Int32Grid& manifold, const Int32Grid& grain);

/// The critical points of largest D (then smaller coordinate) of grains 1, 2, ... ascend
/// lexicographically.
std::string grainsAreInCanonicalOrder(const ManifoldGraph& graph, const Int32Grid& grain);

/// No grain has voxels in two 6-connected components of the object.
std::string grainsStayInOneComponent(const MaskGrid& object, const Int32Grid& grain);

/// Balls ascend lexicographically, have D of the grid, and their cells make up the object.
std::string ballsFillObject(const std::vector<MedialBall>& balls, const Int32Grid& distanceSquared);

/// The voxels of each label are 6-connected: tidied labels of an object without cavities.
std::string grainsAreConnected(const Int32Grid& grain);

/// The counts agree with each other and with the graph.
std::string countsAgree(const Segmentation& segmentation, const MaskGrid& object, int64_t gamma);

/// All of the above that can be checked with the grids that the segmentation kept, and that hold
/// for its options: what ties labels to manifolds holds before they are tidied, what ties a grid
/// to the balls and the graph where no cavity was filled.
std::string anyViolation(const Segmentation& segmentation, const MaskGrid& object, int64_t gamma);

}  // namespace vdb_madf::test
