// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "vdb_madf/grids/domain.h"
#include "vdb_madf/leaves/leaf_index.h"
#include "vdb_madf/leaves/voxel_array.h"
#include "vdb_madf/method/critical_point.h"
#include "vdb_madf/method/flow.h"
#include "vdb_madf/method/voxel_weights.h"

namespace vdb_madf {

/// Critical points and how their stable manifolds touch: all that merging needs.
struct ManifoldGraph {
  /// Nodes are in lexicographic order of position (x, then y, then z).
  using Node = CriticalPoint;
  /// Two stable manifolds that contain 6-adjacent voxels. first < second; edges are sorted by both.
  struct Edge {
    uint32_t first = 0, second = 0;  ///< node indices
    int64_t contactFaces = 0;        ///< adjacent voxel pairs, one in either manifold
    int32_t saddleHeight = 0;        ///< largest min(H(p), H(q)) over these pairs, H = -power
    bool cellsTouch = false;  ///< some pair lies in the cells of the critical points themselves
    bool operator==(const Edge& o) const {
      return first == o.first && second == o.second && contactFaces == o.contactFaces &&
             saddleHeight == o.saddleHeight && cellsTouch == o.cellsTouch;
    }
  };
  std::vector<Node> nodes;
  std::vector<Edge> edges;
  VoxelWeights weights{};  ///< in whose metric radii and heights are
  /// The axis along which the domain is one voxel thick: all is in a plane then (hierarchy.h).
  std::optional<int> flatAxis{};
};

/// The graph of a flow, all but what placeGraph() says and the weights; \p power is the (filtered)
/// power map that it followed.
/// Height of a voxel: H(p) = -power(p) = D(s) - |p - s|^2 with s = Pi(p).
/// @throw Interrupted
ManifoldGraph manifoldGraph(const LeafIndex& index, const Flow& flow,
                            const VoxelArray<int32_t>& power, Interrupter* interrupter = nullptr);

/// Tells a graph, whose weights are known, of the domain in which it lies: the axis along which
/// that is one voxel thick, and, if its boundary is open, of which critical points D is not sure:
/// those with a voxel outside of the domain nearer than D (in a plane: with one of that plane).
void placeGraph(ManifoldGraph& graph, const Domain& domain, bool open);

}  // namespace vdb_madf
