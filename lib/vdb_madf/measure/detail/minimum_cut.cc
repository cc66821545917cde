// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/measure/detail/minimum_cut.h"

#include <algorithm>
#include <limits>

namespace vdb_madf::detail {

namespace {

/// Flow from a source to a sink, raised until no more fits.
class MaximumFlow {
 public:
  explicit MaximumFlow(size_t nodes) : outgoing_(nodes), level_(nodes), next_(nodes) {}

  void add(uint32_t from, uint32_t to, int64_t capacity, int64_t back) {
    outgoing_[from].push_back(uint32_t(arcs_.size()));
    arcs_.push_back({to, capacity});
    outgoing_[to].push_back(uint32_t(arcs_.size()));
    arcs_.push_back({from, back});
  }

  /// Dinic 1970: paths of least length until there are none, then of the next one.
  /// @return of each node whether more could flow to it from the source
  std::vector<bool> run(uint32_t source, uint32_t sink) {
    while (setLevels(source, sink)) {
      std::fill(next_.begin(), next_.end(), 0);
      while (raise(source, sink)) {
      }
    }
    std::vector<bool> reached;
    for (const int level : level_) reached.push_back(level >= 0);
    return reached;
  }

 private:
  struct Arc {
    uint32_t to;
    int64_t capacity;  ///< that is left; that of the arc back is next to it
  };

  /// Least numbers of arcs from the source; -1: out of reach. @return is the sink within reach?
  bool setLevels(uint32_t source, uint32_t sink) {
    std::fill(level_.begin(), level_.end(), -1);
    level_[source] = 0;
    std::vector<uint32_t> queue{source};
    for (size_t i = 0; i < queue.size(); ++i)
      for (const uint32_t index : outgoing_[queue[i]]) {
        const Arc& arc = arcs_[index];
        if (arc.capacity == 0 || level_[arc.to] >= 0) continue;
        level_[arc.to] = level_[queue[i]] + 1;
        queue.push_back(arc.to);
      }
    return level_[sink] >= 0;
  }

  /// Along one path more, from level to level. @return is there one?
  bool raise(uint32_t source, uint32_t sink) {
    std::vector<uint32_t> path;
    for (uint32_t at = source; at != sink;) {
      size_t& next = next_[at];
      while (next < outgoing_[at].size() && !leadsOn(at, arcs_[outgoing_[at][next]])) ++next;
      if (next < outgoing_[at].size()) {
        path.push_back(outgoing_[at][next]);
        at = arcs_[path.back()].to;
      } else if (path.empty()) {
        return false;
      } else {  // a dead end
        at = arcs_[path.back() ^ 1].to;
        path.pop_back();
        ++next_[at];
      }
    }
    int64_t most = std::numeric_limits<int64_t>::max();
    for (const uint32_t index : path) most = std::min(most, arcs_[index].capacity);
    for (const uint32_t index : path) {
      arcs_[index].capacity -= most;
      arcs_[index ^ 1].capacity += most;
    }
    return true;
  }
  bool leadsOn(uint32_t at, const Arc& arc) const {
    return arc.capacity > 0 && level_[arc.to] == level_[at] + 1;
  }

  std::vector<Arc> arcs_;                        // an arc and that back
  std::vector<std::vector<uint32_t>> outgoing_;  // of each node
  std::vector<int> level_;
  std::vector<size_t> next_;  // of the outgoing arcs the first that may lead to the sink
};

}  // namespace

std::vector<bool> minimumCut(size_t nodes, const std::vector<CutEdge>& edges,
                             const std::vector<uint32_t>& sources,
                             const std::vector<uint32_t>& sinks) {
  const auto source = uint32_t(nodes), sink = uint32_t(nodes + 1);
  MaximumFlow flow(nodes + 2);
  int64_t all = 1;
  for (const CutEdge& edge : edges) {
    flow.add(edge.nodes[0], edge.nodes[1], edge.cost, edge.cost);
    all += edge.cost;
  }
  for (const uint32_t node : sources) flow.add(source, node, all, 0);
  for (const uint32_t node : sinks) flow.add(node, sink, all, 0);
  std::vector<bool> side = flow.run(source, sink);
  side.resize(nodes);
  return side;
}

}  // namespace vdb_madf::detail
