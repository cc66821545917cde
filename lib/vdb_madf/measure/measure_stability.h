// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include "vdb_madf/measure/measure.h"
#include "vdb_madf/method/manifold_graph.h"

namespace vdb_madf {

/// Adds the strictnesses between which each grain is the same, and that at which each bond
/// vanishes (method/grain_lives.h), to measures of labels that were merged by score. With a
/// minGrain a grain counts without the small ones that joined it.
/// @param graph of the manifolds of the labels (graph_metadata.h)
/// @throw InvalidInput if the labels do not say that score merged them, were edited, or have other
///   grains than the graph at their strictness.
void measureStability(const ManifoldGraph& graph, Measurements& measurements);

}  // namespace vdb_madf
