// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstdint>
#include <vector>

#include "vdb_madf/verify/detail/flow_by_rows.h"

namespace vdb_madf::detail {

/// The critical points, in the order of coordinates, and which of them touch.
struct Manifolds {
  struct Node {
    int32_t at = 0;  ///< the number of its voxel
    int64_t top = 0, objectVoxels = 0, voxels = 0;
    bool isSure = true;  ///< Does all that is nearer than its top lie in an open domain?
  };
  struct Edge {
    int32_t first = 0, second = 0;
    int64_t faces = 0, height = INT64_MIN;
    bool cellsTouch = false;
  };
  std::vector<Node> nodes;
  std::vector<Edge> edges;
};
/// Turns the critical points of the flow into indices of nodes.
Manifolds manifoldsOf(const DenseBox& space, const Definition& definition, const Voxels& voxels,
                      const std::vector<int32_t>& distance, Flow& flow);

struct Grains {
  std::vector<int32_t> ofNode;          ///< 0: none
  std::vector<int32_t> representative;  ///< node, of grain g at g - 1
};
Grains grainsOf(const DenseBox& space, const Definition& definition, const Manifolds& manifolds);

/// Step 7b: labels of the object (0: none) become tidy.
void tidyUp(const DenseBox& space, const Definition& definition, const Manifolds& manifolds,
            const Grains& grains, std::vector<int32_t>& label, Interrupter* interrupter);

}  // namespace vdb_madf::detail
