// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/slabs/detail/merge_parts.h"

#include <utility>

#include "vdb_madf/base/detail/parallel.h"

namespace vdb_madf::detail {

void MergeParts::About::add(const About& other) {
  if (other.top > top || (other.top == top && other.representative < representative)) {
    top = other.top;
    representative = other.representative;
  }
  hasVoxels = hasVoxels || other.hasVoxels;
}

std::vector<uint32_t> MergeParts::add(const GraphPart& part) {
  std::vector<uint32_t> place = placesOf(part);
  addEdges(part.graph, place);
  for (size_t i = 0; i < place.size(); ++i)
    if (part.goesOn[i])
      open_[part.graph.nodes[i].position] = place[i];
    else
      open_.erase(part.graph.nodes[i].position);
  for (auto& c : group_.classes) c.isOpen = false;
  for (const auto& [position, c] : open_) group_.classes[c].isOpen = true;

  const std::vector<uint32_t> after = contract(group_, rule_);
  follow(after);
  for (uint32_t& p : place) p = number_[after[p]];
  dropDecided();
  return place;
}

/// What is known of the classes, after they were contracted; gives numbers to all.
void MergeParts::follow(const std::vector<uint32_t>& after) {
  std::vector<About> about(group_.classes.size());
  std::vector<uint32_t> number(group_.classes.size(), kNone);
  for (size_t i = 0; i < after.size(); ++i) {
    about[after[i]].add(about_[i]);
    if (number_[i] == kNone) continue;
    uint32_t& n = number[after[i]];
    if (n != kNone) numbers_.unite(n, number_[i]);
    n = numbers_.find(number_[i]);
  }
  for (size_t c = 0; c < number.size(); ++c) {
    if (number[c] == kNone) {
      number[c] = numbers_.add();
      aboutNumber_.emplace_back();
    }
    aboutNumber_[number[c]] = about[c];
  }
  about_ = std::move(about);
  number_ = std::move(number);
  for (auto& [position, c] : open_) c = after[c];
}

/// The classes of nodes, in the group; new ones for those that are new.
std::vector<uint32_t> MergeParts::placesOf(const GraphPart& part) {
  std::vector<uint32_t> place;
  place.reserve(part.graph.nodes.size());
  for (const CriticalPoint& node : part.graph.nodes) {
    const auto open = open_.find(node.position);
    if (open != open_.end()) {
      place.push_back(open->second);
    } else {
      place.push_back(uint32_t(group_.classes.size()));
      group_.classes.push_back({node.squaredRadius, false});
      about_.push_back({node.position, node.squaredRadius, false});
      number_.push_back(kNone);
    }
    if (node.voxels > 0) about_[place.back()].hasVoxels = true;
  }
  return place;
}

void MergeParts::addEdges(const ManifoldGraph& graph, const std::vector<uint32_t>& place) {
  for (const ManifoldGraph::Edge& edge : graph.edges) {
    const CriticalPoint &a = graph.nodes[edge.first], &b = graph.nodes[edge.second];
    const bool isCertain = rule_.mergesByAngle(a, b, edge.cellsTouch);
    if (!isCertain && !rule_.seesNeck(edge.saddleHeight)) continue;
    group_.edges.push_back({place[edge.first], place[edge.second],
                            isCertain ? MergeGroup::kCertain : edge.saddleHeight, a.position,
                            b.position});
  }
}

/// Takes the classes out of the group that are neither open nor have an edge.
void MergeParts::dropDecided() {
  std::vector<char> stays(group_.classes.size(), 0);
  for (size_t c = 0; c < stays.size(); ++c) stays[c] = group_.classes[c].isOpen;
  for (const MergeGroup::Edge& edge : group_.edges) stays[edge.first] = stays[edge.second] = 1;
  std::vector<uint32_t> place(stays.size(), kNone);
  uint32_t count = 0;
  for (size_t c = 0; c < stays.size(); ++c) {
    if (!stays[c]) continue;
    place[c] = count;
    group_.classes[count] = group_.classes[c];
    about_[count] = about_[c];
    number_[count++] = number_[c];
  }
  group_.classes.resize(count);
  about_.resize(count);
  number_.resize(count);
  for (MergeGroup::Edge& edge : group_.edges) {
    edge.first = place[edge.first];
    edge.second = place[edge.second];
  }
  for (auto& [position, c] : open_) c = place[c];
}

PartGrains MergeParts::finish() {
  std::vector<uint32_t> grains;
  for (uint32_t n = 0; n < aboutNumber_.size(); ++n)
    if (numbers_.find(n) == n && aboutNumber_[n].hasVoxels) grains.push_back(n);
  parallelSort(grains.begin(), grains.end(), [&](uint32_t a, uint32_t b) {
    return aboutNumber_[a].representative < aboutNumber_[b].representative;
  });
  PartGrains result;
  result.grainOfClass.assign(aboutNumber_.size(), 0);
  for (const uint32_t n : grains) {
    result.representative.push_back(aboutNumber_[n].representative);
    result.grainOfClass[n] = uint32_t(result.representative.size());
  }
  for (uint32_t n = 0; n < aboutNumber_.size(); ++n)
    result.grainOfClass[n] = result.grainOfClass[numbers_.find(n)];
  return result;
}

}  // namespace vdb_madf::detail
