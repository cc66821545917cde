// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <algorithm>
#include <cmath>
#include <set>

#include "support/random_volume.h"
#include "vdb_madf/method/manifold_graph.h"

// Random graphs of manifolds, to be joined by score.

namespace vdb_madf::test {

/// A logarithmic number up to a largest one.
inline int64_t logarithmic(Rng& rng, double bits) {
  return int64_t(std::exp2(rng.unit() * bits));
}

/// Few different radii, sizes, faces and heights: many ties.
inline ManifoldGraph randomGraph(Rng& rng) {
  std::set<Coord> positions;
  const bool alike = rng.chance(0.3);
  const int side = rng.between(2, 12), count = rng.between(1, 24),
            radii = alike ? 1 + rng.below(2) : rng.between(1, 30),
            sizes = alike ? 1 + rng.below(2) : rng.between(1, 200),
            faces = alike ? 1 + rng.below(2) : rng.between(1, 60);
  const bool anySize = !alike && rng.chance(0.3);
  for (int i = 0; i < count; ++i)
    positions.insert({rng.below(side), rng.below(side), rng.below(side)});
  ManifoldGraph graph;
  const double empty = rng.chance(0.2) ? 0.3 : 0;   // nodes without voxels of the object
  const double hollow = rng.chance(0.3) ? 0.3 : 0;  // nodes with voxels in cavities
  for (const Coord& p : positions)
    graph.nodes.push_back({p, 2 + rng.below(radii),
                           rng.chance(empty) ? 0
                           : anySize         ? logarithmic(rng, 16)
                                             : 1 + rng.below(sizes),
                           rng.chance(hollow) ? rng.below(20) : 0});
  const double density = rng.unit() * rng.unit(), steep = rng.chance(0.3) ? rng.unit() : 0;
  for (uint32_t a = 0; a < graph.nodes.size(); ++a)
    for (uint32_t b = a + 1; b < graph.nodes.size(); ++b) {
      if (!rng.chance(density)) continue;
      int highest = std::min(graph.nodes[a].squaredRadius, graph.nodes[b].squaredRadius);
      if (!rng.chance(steep)) --highest;  // few are no local maximum
      graph.edges.push_back({a, b, 1 + rng.below(faces), rng.between(-2, highest), false});
    }
  if (rng.chance(0.2)) graph.weights = {rng.between(1, 9), rng.between(1, 9), rng.between(1, 9)};
  if (rng.chance(0.3)) graph.flatAxis = rng.below(3);
  const double doubtful = rng.chance(0.5) ? rng.unit() : 0;
  for (ManifoldGraph::Node& node : graph.nodes)
    if (rng.chance(doubtful))
      node.doubt = rng.chance(0.7) ? node.squaredRadius : rng.below(node.squaredRadius);
  return graph;
}

}  // namespace vdb_madf::test
