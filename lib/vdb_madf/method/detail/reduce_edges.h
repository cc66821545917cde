// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <vector>

#include "vdb_madf/method/manifold_graph.h"

namespace vdb_madf::detail {

/// Sorts edges by their pair and joins those of the same one.
void reduceEdges(std::vector<ManifoldGraph::Edge>& edges);

}  // namespace vdb_madf::detail
