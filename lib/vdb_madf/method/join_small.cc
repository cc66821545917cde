// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/method/join_small.h"

#include <algorithm>
#include <cstddef>
#include <map>
#include <numeric>
#include <set>
#include <unordered_map>
#include <utility>

namespace vdb_madf {

namespace {

/// Small grains alone know their neighbors: so what is moved is the contacts of a crumb.
class SmallJoining {
 public:
  SmallJoining(std::vector<int64_t> voxels, const std::vector<GrainContact>& contacts,
               int64_t least)
      : voxels_(std::move(voxels)), least_(least), into_(voxels_.size()) {
    std::iota(into_.begin(), into_.end(), 0u);
    for (uint32_t i = 0; i < into_.size(); ++i)
      if (isSmall(i)) waiting_.emplace(voxels_[i], i);
    for (const auto& [first, second, faces] : contacts) {
      if (isSmall(first)) around_[first][second] += faces;
      if (isSmall(second)) around_[second][first] += faces;
    }
  }

  std::vector<uint32_t> run() {
    while (!waiting_.empty()) {
      const uint32_t small = waiting_.begin()->second;
      waiting_.erase(waiting_.begin());
      const auto known = around_.find(small);
      if (known == around_.end()) continue;
      const Faces faces = std::move(known->second);
      around_.erase(known);
      join(small, faces);
    }
    for (uint32_t& to : into_)
      while (into_[to] != to) to = into_[to];
    return std::move(into_);
  }

 private:
  using Faces = std::map<uint32_t, int64_t>;  // by neighbor

  bool isSmall(uint32_t grain) const { return voxels_[grain] < least_; }

  void join(uint32_t small, const Faces& faces) {
    const uint32_t to =
        std::max_element(faces.begin(), faces.end(), [](const auto& a, const auto& b) {
          return a.second < b.second;
        })->first;
    into_[small] = to;
    const bool toKnows = isSmall(to);
    if (toKnows) waiting_.erase({voxels_[to], to});
    voxels_[to] += voxels_[small];
    for (const auto& [other, shared] : faces) {
      if (const auto known = around_.find(other); known != around_.end()) {
        known->second.erase(small);
        if (other != to) known->second[to] += shared;
      }
      if (toKnows && other != to) around_[to][other] += shared;
    }
    if (!toKnows) return;
    if (!isSmall(to) || around_[to].empty()) around_.erase(to);
    if (isSmall(to)) waiting_.emplace(voxels_[to], to);
  }

  std::vector<int64_t> voxels_;
  const int64_t least_;
  std::vector<uint32_t> into_;  // the neighbor that each one has joined
  std::set<std::pair<int64_t, uint32_t>> waiting_;
  std::unordered_map<uint32_t, Faces> around_;  // of small grains that touch others
};

}  // namespace

std::vector<uint32_t> joinSmall(std::vector<int64_t> voxels,
                                const std::vector<GrainContact>& contacts, int64_t least) {
  return SmallJoining(std::move(voxels), contacts, least).run();
}

Merging joinSmallGrains(const ManifoldGraph& graph, const Merging& merging, int64_t least) {
  std::vector<GrainContact> contacts;
  for (const ManifoldGraph::Edge& edge : graph.edges) {
    const int32_t first = merging.grainOfNode[edge.first],
                  second = merging.grainOfNode[edge.second];
    if (first == 0 || second == 0 || first == second) continue;
    contacts.push_back({uint32_t(first - 1), uint32_t(second - 1), edge.contactFaces});
  }
  const std::vector<uint32_t> into = joinSmall(grainVoxels(graph, merging), contacts, least);
  std::vector<uint32_t> classOfNode;
  classOfNode.reserve(merging.grainOfNode.size());
  for (const int32_t grain : merging.grainOfNode)
    classOfNode.push_back(grain == 0 ? 0 : into[size_t(grain - 1)] + 1);
  return mergeClasses(graph, classOfNode);
}

}  // namespace vdb_madf
