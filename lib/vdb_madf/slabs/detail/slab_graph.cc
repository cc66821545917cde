// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/slabs/detail/slab_graph.h"

#include <algorithm>
#include <utility>

#include "vdb_madf/base/errors.h"
#include "vdb_madf/method/detail/reduce_edges.h"

namespace vdb_madf::detail {

namespace {

using Edge = ManifoldGraph::Edge;

uint32_t withoutFlag(uint32_t terminal) {
  return (terminal & ~Flow::kOwnCell) - 1;
}

/// The node at a position, which there is.
uint32_t nodeAt(const ManifoldGraph& graph, const Coord& position) {
  const auto found =
      std::lower_bound(graph.nodes.begin(), graph.nodes.end(), position,
                       [](const CriticalPoint& a, const Coord& p) { return a.position < p; });
  return uint32_t(found - graph.nodes.begin());
}

/// Ascending, each once, without voxels.
std::vector<CriticalPoint> sortedNodes(std::vector<CriticalPoint> nodes) {
  std::sort(nodes.begin(), nodes.end(),
            [](const CriticalPoint& a, const CriticalPoint& b) { return a.position < b.position; });
  const auto end = std::unique(
      nodes.begin(), nodes.end(),
      [](const CriticalPoint& a, const CriticalPoint& b) { return a.position == b.position; });
  nodes.erase(end, nodes.end());
  for (CriticalPoint& node : nodes) node.voxels = 0;
  return nodes;
}

}  // namespace

size_t SlabGraph::slabOf(int z) const {
  return size_t(std::upper_bound(cuts_.begin(), cuts_.end(), z) - cuts_.begin()) - 1;
}

size_t SlabGraph::slabOfTerminal(uint32_t terminal) const {
  return size_t(std::upper_bound(first_.begin(), first_.end(), terminal) - first_.begin()) - 1;
}

void SlabGraph::add(const SlabTerminals& terminals) {
  const size_t slab = slabCount();
  const uint32_t first = first_.back();
  if (first + terminals.points.size() >= Flow::kOwnCell)
    throw InvalidInput("there are more than 2^31 critical points: coarsen the volume");
  questions_.resize(cuts_.size() - 1);
  for (uint32_t i = 0; i < terminals.points.size(); ++i) {
    const Coord& position = terminals.points[i].position;
    const size_t owner = slabOf(position.z());
    if (owner == slab) {
      ++criticalPoints_;
      continue;
    }
    questions_[owner].push_back({position, uint32_t(foreign_.size())});
    foreign_.push_back({first + i, first + i});
  }
  first_.push_back(first + uint32_t(terminals.points.size()));
}

const std::vector<SlabGraph::Question>& SlabGraph::questions(size_t slab) {
  std::sort(questions_[slab].begin(), questions_[slab].end(),
            [](const Question& a, const Question& b) { return a.position < b.position; });
  return questions_[slab];
}

void SlabGraph::answer(size_t slab, const Question& question, uint32_t terminal) {
  foreign_[question.terminal].next = first_[slab] + withoutFlag(terminal);
}

const SlabGraph::Foreign* SlabGraph::findForeign(uint32_t terminal) const {
  const auto found =
      std::lower_bound(foreign_.begin(), foreign_.end(), terminal,
                       [](const Foreign& a, uint32_t number) { return a.terminal < number; });
  return found != foreign_.end() && found->terminal == terminal ? &*found : nullptr;
}

std::vector<SlabGraph::Shared>::const_iterator SlabGraph::sharedFrom(uint32_t terminal) const {
  return std::lower_bound(shared_.begin(), shared_.end(), terminal,
                          [](const Shared& a, uint32_t number) { return a.terminal < number; });
}

void SlabGraph::finish() {
  questions_ = {};
  for (Foreign& foreign : foreign_) {
    // D rises on the way: there is an end.
    while (const Foreign* next = findForeign(foreign.next)) foreign.next = next->next;
    const auto last = std::max(slabOfTerminal(foreign.terminal), slabOfTerminal(foreign.next));
    shared_.push_back({foreign.next, uint32_t(last)});
  }
  std::sort(shared_.begin(), shared_.end(), [](const Shared& a, const Shared& b) {
    return a.terminal != b.terminal ? a.terminal < b.terminal : a.last > b.last;
  });
  const auto end =
      std::unique(shared_.begin(), shared_.end(),
                  [](const Shared& a, const Shared& b) { return a.terminal == b.terminal; });
  shared_.erase(end, shared_.end());
  shared_.shrink_to_fit();
}

bool SlabGraph::isShared(size_t slab) const {
  return sharedFrom(first_[slab]) != sharedFrom(first_[slab + 1]);
}

void SlabGraph::tellShared(size_t slab, const std::vector<CriticalPoint>& points,
                           const std::vector<uint32_t>& numbers) {
  const auto begin = size_t(sharedFrom(first_[slab]) - shared_.cbegin());
  const auto end = size_t(sharedFrom(first_[slab + 1]) - shared_.cbegin());
  for (size_t i = begin; i < end; ++i) {
    const uint32_t terminal = shared_[i].terminal - first_[slab];
    shared_[i].point = points[terminal];
    if (!numbers.empty()) shared_[i].number = numbers[terminal];
  }
}

std::vector<SlabGraph::Root> SlabGraph::rootsOf(size_t slab,
                                                const std::vector<CriticalPoint>& points,
                                                const std::vector<uint32_t>& numbers) const {
  std::vector<Root> roots;
  roots.reserve(points.size());
  for (size_t i = 0; i < points.size(); ++i)
    roots.push_back({points[i], numbers.empty() ? 0 : numbers[i], uint32_t(slab), true});
  const auto set = [&](uint32_t terminal, const Shared& shared) {
    Root& root = roots[terminal - first_[slab]];
    // A ball that is critical is the terminal of its own voxel: it is one, whoever asks.
    root = {shared.point, shared.number, shared.last, root.point.position == shared.point.position};
  };
  for (auto shared = sharedFrom(first_[slab]); shared != sharedFrom(first_[slab + 1]); ++shared)
    set(shared->terminal, *shared);
  const auto from =
      std::lower_bound(foreign_.begin(), foreign_.end(), first_[slab],
                       [](const Foreign& a, uint32_t number) { return a.terminal < number; });
  for (auto foreign = from; foreign != foreign_.end() && foreign->terminal < first_[slab + 1];
       ++foreign)
    set(foreign->terminal, *sharedFrom(foreign->next));
  return roots;
}

SlabGraph::Part SlabGraph::nextPart(const SlabTerminals& terminals,
                                    const std::vector<uint32_t>& numbers,
                                    const std::vector<Edge>& below,
                                    const std::vector<Edge>& above) {
  const size_t slab = parts_++;
  std::vector<Root> roots = rootsOf(slab, terminals.points, numbers);

  Part part;
  ManifoldGraph& graph = part.graph;
  std::vector<CriticalPoint> nodes;
  for (const Root& root : roots) nodes.push_back(root.point);
  for (const Edge& edge : below) nodes.push_back(rootsBelow_[edge.first].point);
  graph.nodes = sortedNodes(std::move(nodes));

  part.number.assign(graph.nodes.size(), 0);
  part.goesOn.assign(graph.nodes.size(), 0);
  const auto nodeOf = [&](const Root& root) {
    const uint32_t node = nodeAt(graph, root.point.position);
    part.number[node] = root.number;
    if (root.last > slab) part.goesOn[node] = 1;
    return node;
  };
  for (size_t i = 0; i < roots.size(); ++i) {
    part.nodeOf.push_back(nodeOf(roots[i]));
    graph.nodes[part.nodeOf[i]].voxels += terminals.points[i].voxels;
  }
  const auto addEdge = [&](Edge edge, uint32_t a, uint32_t b, bool areTerminals) {
    if (a == b) return;
    edge.first = std::min(a, b);
    edge.second = std::max(a, b);
    edge.cellsTouch = edge.cellsTouch && areTerminals;
    graph.edges.push_back(edge);
  };
  for (const Edge& edge : terminals.edges)
    addEdge(edge, part.nodeOf[edge.first], part.nodeOf[edge.second],
            roots[edge.first].isTerminal && roots[edge.second].isTerminal);
  for (const Edge& edge : below)
    addEdge(edge, nodeOf(rootsBelow_[edge.first]), part.nodeOf[edge.second],
            rootsBelow_[edge.first].isTerminal && roots[edge.second].isTerminal);
  reduceEdges(graph.edges);
  // The next part has these contacts.
  for (const Edge& edge : above) part.goesOn[part.nodeOf[edge.first]] = 1;
  rootsBelow_ = std::move(roots);
  return part;
}

}  // namespace vdb_madf::detail
