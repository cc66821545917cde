// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/slabs/detail/slab_graph.h"

#include <algorithm>
#include <numeric>

#include "vdb_madf/base/detail/parallel.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/method/detail/reduce_edges.h"

namespace vdb_madf::detail {

namespace {

using Edge = ManifoldGraph::Edge;

}  // namespace

size_t SlabGraph::slabOf(int z) const {
  return size_t(std::upper_bound(cuts_.begin(), cuts_.end(), z) - cuts_.begin()) - 1;
}

void SlabGraph::add(const SlabTerminals& terminals) {
  const size_t slab = first_.size() - 1;
  const uint32_t first = first_.back();
  if (points_.size() + terminals.points.size() >= Flow::kOwnCell)
    throw InvalidInput("there are more than 2^31 critical points: coarsen the volume");
  questions_.resize(cuts_.size() - 1);
  for (const CriticalPoint& point : terminals.points) {
    const auto number = uint32_t(points_.size());
    const size_t owner = slabOf(point.position.z());
    if (owner != slab) questions_[owner].push_back({point.position, number});
    points_.push_back(point);
    next_.push_back(number);
  }
  for (Edge edge : terminals.edges) {
    edge.first += first;
    edge.second += first;
    edges_.push_back(edge);
  }
  first_.push_back(uint32_t(points_.size()));
}

void SlabGraph::addContacts(const std::vector<Edge>& contacts) {
  const size_t above = first_.size() - 2;
  for (Edge edge : contacts) {
    edge.first += first_[above - 1];
    edge.second += first_[above];
    edges_.push_back(edge);
  }
}

const std::vector<SlabGraph::Question>& SlabGraph::questions(size_t slab) {
  std::sort(questions_[slab].begin(), questions_[slab].end(),
            [](const Question& a, const Question& b) { return a.position < b.position; });
  return questions_[slab];
}

void SlabGraph::answer(size_t slab, const Question& question, uint32_t terminal) {
  next_[question.terminal] = first_[slab] + (terminal & ~Flow::kOwnCell) - 1;
}

ManifoldGraph SlabGraph::finish() {
  // A ball that is critical is the terminal of its own voxel: it is one, whoever asks.
  std::vector<char> isCritical(points_.size());
  for (uint32_t i = 0; i < points_.size(); ++i)
    isCritical[i] = points_[next_[i]].position == points_[i].position;
  std::vector<uint32_t> order;
  for (uint32_t i = 0; i < next_.size(); ++i) {
    if (next_[i] == i) order.push_back(i);
    uint32_t root = i;  // D rises on the way: there is an end
    while (next_[root] != root) root = next_[root];
    next_[i] = root;
  }
  parallelSort(order.begin(), order.end(),
               [&](uint32_t a, uint32_t b) { return points_[a].position < points_[b].position; });

  ManifoldGraph graph;
  std::vector<uint32_t> nodeOf(points_.size());
  for (const uint32_t i : order) {
    nodeOf[i] = uint32_t(graph.nodes.size());
    graph.nodes.push_back(points_[i]);
    graph.nodes.back().voxels = 0;
  }
  for (uint32_t i = 0; i < next_.size(); ++i) {
    next_[i] = nodeOf[next_[i]];
    graph.nodes[next_[i]].voxels += points_[i].voxels;
  }
  for (Edge edge : edges_) {
    edge.cellsTouch = edge.cellsTouch && isCritical[edge.first] && isCritical[edge.second];
    const uint32_t a = next_[edge.first], b = next_[edge.second];
    if (a == b) continue;
    edge.first = std::min(a, b);
    edge.second = std::max(a, b);
    graph.edges.push_back(edge);
  }
  points_ = {};
  edges_ = {};
  reduceEdges(graph.edges);
  return graph;
}

std::vector<uint32_t> SlabGraph::nodesOf(size_t slab) const {
  return {next_.begin() + first_[slab], next_.begin() + first_[slab + 1]};
}

}  // namespace vdb_madf::detail
