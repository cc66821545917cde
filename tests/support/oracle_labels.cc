// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

// The oracle's grains: how manifolds merge, and what tidy makes of the labels.

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <stdexcept>
#include <tuple>
#include <utility>

#include "support/oracle.h"

namespace vdb_madf::test {

// ----------------------------------------------------------------------------------- Merge

namespace {

/// Step 8: the representative has the largest D; of equal ones the first in node order.
Merging numbered(const ManifoldGraph& graph, const std::vector<uint32_t>& classOf) {
  const auto& nodes = graph.nodes;
  std::map<uint32_t, uint32_t> representative;  // by class
  for (uint32_t i = 0; i < nodes.size(); ++i) {
    const auto known = representative.find(classOf[i]);
    if (known == representative.end() ||
        nodes[i].squaredRadius > nodes[known->second].squaredRadius)
      representative[classOf[i]] = i;
  }
  Merging merging;
  for (const auto& [c, node] : representative) {
    int64_t voxels = 0;
    for (size_t i = 0; i < nodes.size(); ++i)
      if (classOf[i] == c) voxels += nodes[i].voxels;
    if (voxels > 0) merging.representative.push_back(node);  // else it is no grain
  }
  std::sort(merging.representative.begin(), merging.representative.end());
  std::map<uint32_t, int32_t> number;
  int32_t grains = 0;
  for (const uint32_t r : merging.representative) number[classOf[r]] = ++grains;
  for (const uint32_t c : classOf) merging.grainOfNode.push_back(number[c]);
  return merging;
}

}  // namespace

std::vector<uint32_t> oracleJoinSmall(const ManifoldGraph& graph,
                                      const std::vector<int32_t>& grainOfNode, int64_t least) {
  std::vector<uint32_t> grainOf(grainOfNode.begin(), grainOfNode.end());
  for (bool joined = true; joined;) {
    joined = false;
    std::map<uint32_t, int64_t> voxels;
    for (size_t i = 0; i < grainOf.size(); ++i) voxels[grainOf[i]] += graph.nodes[i].voxels;
    std::set<std::pair<int64_t, uint32_t>> small;
    for (const auto& [grain, size] : voxels)
      if (grain != 0 && size < least) small.emplace(size, grain);
    for (const auto& [size, grain] : small) {
      std::map<uint32_t, int64_t> faces;  // by neighbor
      for (const auto& edge : graph.edges) {
        const uint32_t a = grainOf[edge.first], b = grainOf[edge.second];
        if (a == grain && b != grain && b != 0) faces[b] += edge.contactFaces;
        if (b == grain && a != grain && a != 0) faces[a] += edge.contactFaces;
      }
      if (faces.empty()) continue;
      uint32_t to = faces.begin()->first;
      for (const auto& [other, shared] : faces)  // ascending
        if (shared > faces[to]) to = other;
      for (uint32_t& g : grainOf)
        if (g == grain) g = to;
      joined = true;
      break;
    }
  }
  return grainOf;
}

Merging oracleMerge(const ManifoldGraph& graph, const MergeOptions& options) {
  const double theta = options.theta;
  if (!(theta >= -1 && theta <= 1)) throw Undefined("theta is not in [-1, 1]");
  if (options.delta < 0 || options.delta > 80) throw Undefined("delta is not in 0..80");
  if (options.minGrain < 0) throw Undefined("minGrain is negative");
  const auto& nodes = graph.nodes;
  const VoxelWeights& weights = graph.weights;
  const int shortest = std::min({weights.x, weights.y, weights.z});  // an edge, squared
  // The class of a node is named after any one of its nodes.
  std::vector<uint32_t> classOf(nodes.size());
  for (uint32_t i = 0; i < nodes.size(); ++i) classOf[i] = i;
  const auto unite = [&](uint32_t a, uint32_t b) {
    const uint32_t from = classOf[b], to = classOf[a];
    for (uint32_t& c : classOf)
      if (c == from) c = to;
  };
  const auto top = [&](uint32_t c) {
    int32_t largest = 0;
    for (size_t i = 0; i < nodes.size(); ++i)
      if (classOf[i] == c) largest = std::max(largest, nodes[i].squaredRadius);
    return largest;
  };

  if (options.mode == MergeMode::score)
    classOf = oracleCut(graph, oracleHierarchy(graph), options.strictness);

  // The angle test.
  if (options.mode == MergeMode::both || options.mode == MergeMode::angle)
    for (const auto& edge : graph.edges) {
      if (options.adjacency == Adjacency::cell && !edge.cellsTouch) continue;
      const auto &ci = nodes[edge.first], &cj = nodes[edge.second];
      const int64_t numerator =
          squaredLength(ci.position - cj.position, weights) - ci.squaredRadius - cj.squaredRadius;
      const int64_t product = int64_t(ci.squaredRadius) * cj.squaredRadius;
      if (double(numerator) / (2 * std::sqrt(double(product))) < theta)
        unite(edge.first, edge.second);
    }

  // The neck test. Nodes are in lexicographic order, so the order of pairs is that of their
  // indices.
  if (options.mode == MergeMode::both || options.mode == MergeMode::neck) {
    auto edges = graph.edges;
    std::sort(edges.begin(), edges.end(), [](const auto& a, const auto& b) {
      return std::make_tuple(-int64_t(a.saddleHeight), a.first, a.second) <
             std::make_tuple(-int64_t(b.saddleHeight), b.first, b.second);
    });
    for (const auto& edge : edges) {
      if (edge.saddleHeight <= 0) break;
      const uint32_t a = classOf[edge.first], b = classOf[edge.second];
      if (a == b) continue;
      const int32_t m = std::min(top(a), top(b));
      // sqrt(m) - sqrt(h) < k sqrt(w) / 8, so 64 (m - h) - k^2 w < 16 k sqrt(w h)
      const __int128 k = options.delta, h = edge.saddleHeight, w = shortest,
                     l = 64 * (m - h) - k * k * w;
      const bool within = l < 0 || l * l < 256 * k * k * w * h;
      if (double(edge.saddleHeight) >= ((1 - theta) / 2) * double(m) || (k > 0 && within))
        unite(edge.first, edge.second);
    }
  }

  Merging merging = numbered(graph, classOf);
  if (options.minGrain > 0)
    merging = numbered(graph, oracleJoinSmall(graph, merging.grainOfNode, options.minGrain));
  return merging;
}

// ------------------------------------------------------------------------------------ Tidy

namespace {

/// The voxel of a label that is nearest to a point, then of smaller coordinate.
Coord nearestOf(const DenseVolume<int64_t>& labels, int64_t label, const Coord& point,
                const VoxelWeights& weights) {
  int best = -1;  // volumes are in the order of coordinates
  for (int i = 0; i < labels.size(); ++i)
    if (labels[i] == label && (best < 0 || squaredLength(labels.coord(i) - point, weights) <
                                               squaredLength(labels.coord(best) - point, weights)))
      best = i;
  return labels.coord(best);
}

int64_t smoothed(const DenseVolume<int64_t>& labels, const Coord& p) {
  const int64_t own = labels[p];
  std::set<int64_t> candidates{own};
  for (const Coord& step : kSixNeighbors)
    if (const int64_t label = labels.get(p + step, 0)) candidates.insert(label);
  std::map<int64_t, int> count;
  for (int x = -1; x <= 1; ++x)
    for (int y = -1; y <= 1; ++y)
      for (int z = -1; z <= 1; ++z) ++count[labels.get(p + Coord(x, y, z), 0)];
  int largest = 0;
  for (const int64_t c : candidates) largest = std::max(largest, count[c]);
  if (count[own] == largest) return own;
  for (const int64_t c : candidates)  // ascending
    if (count[c] == largest) return c;
  throw std::logic_error("no label has the largest count");
}

/// The voxels that a 6-connected path of their label joins with one of the seeds.
ObjectVolume reached(const DenseVolume<int64_t>& labels, std::vector<Coord> front) {
  ObjectVolume held(labels.box());
  for (const Coord& p : front) held[p] = 1;
  while (!front.empty()) {
    const Coord p = front.back();
    front.pop_back();
    for (const Coord& step : kSixNeighbors) {
      const Coord q = p + step;
      if (labels.get(q, 0) != labels[p] || held[q]) continue;
      held[q] = 1;
      front.push_back(q);
    }
  }
  return held;
}

}  // namespace

DenseVolume<int64_t> oracleTidy(const DenseVolume<int64_t>& given,
                                const std::vector<Coord>& representatives, int rounds,
                                const VoxelWeights& weights) {
  if (rounds < 0) throw Undefined("tidy is negative");
  if (rounds == 0) return given;
  std::vector<Coord> anchors;
  for (size_t g = 0; g < representatives.size(); ++g)
    anchors.push_back(nearestOf(given, int64_t(g) + 1, representatives[g], weights));
  const std::set<Coord> fixed(anchors.begin(), anchors.end());

  DenseVolume<int64_t> labels = given;
  for (int round = 0; round < rounds; ++round) {
    const DenseVolume<int64_t> before = labels;
    for (int i = 0; i < labels.size(); ++i)
      if (before[i] && !fixed.count(before.coord(i))) labels[i] = smoothed(before, before.coord(i));
  }

  const DenseVolume<int64_t> smooth = labels;
  const ObjectVolume held = reached(smooth, anchors);
  for (int i = 0; i < labels.size(); ++i)
    if (!held[i]) labels[i] = 0;
  for (bool changed = true; changed;) {
    changed = false;
    const DenseVolume<int64_t> before = labels;
    for (int i = 0; i < labels.size(); ++i) {
      if (!given[i] || before[i]) continue;
      std::map<int64_t, int> count;
      for (const Coord& step : kSixNeighbors)
        if (const int64_t label = before.get(before.coord(i) + step, 0)) ++count[label];
      int largest = 0;
      for (const auto& [label, faces] : count)
        if (faces > largest) {  // of equal ones the smallest
          largest = faces;
          labels[i] = label;
          changed = true;
        }
    }
  }
  for (int i = 0; i < labels.size(); ++i)
    if (given[i] && !labels[i]) labels[i] = smooth[i];
  return labels;
}

LabelFlaws oracleFlaws(const DenseVolume<int64_t>& labels, int64_t grains,
                       const std::optional<OracleDomain>& domain) {
  LabelFlaws flaws;
  for (int64_t g = 1; g <= grains; ++g) {
    ObjectVolume grain(labels.box());
    bool touches = false, deep = false;
    for (int i = 0; i < labels.size(); ++i) {
      if (labels[i] != g) continue;
      grain[i] = 1;
      const Coord p = labels.coord(i);
      for (const Coord& step : kSixNeighbors) {
        const int64_t other = labels.get(p + step, 0);
        touches = touches || (other != 0 && other != g);
      }
      bool all = true;
      for (int x = -1; x <= 1; ++x)
        for (int y = -1; y <= 1; ++y)
          for (int z = -1; z <= 1; ++z) {
            const Coord q = p + Coord(x, y, z);
            all = all && (labels.get(q, 0) == g || (domain && !domain->isInside(q)));
          }
      deep = deep || all;
    }
    const int64_t voxels = countObject(grain);
    const DenseVolume<int> component = sixComponents(grain);
    int components = 0;
    for (int i = 0; i < component.size(); ++i) components = std::max(components, component[i]);
    flaws.crumbs += voxels < 100 && touches;
    flaws.specks += voxels < 100 && !touches;
    flaws.slivers += voxels >= 20 && touches && !deep;
    flaws.inPieces += components > 1;
  }
  return flaws;
}

}  // namespace vdb_madf::test
