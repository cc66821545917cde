// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/slabs/cuts/merge_parts.h"

#include <utility>

#include "vdb_madf/base/detail/parallel.h"

namespace vdb_madf::detail {

void OpenGraph::About::add(const About& other) {
  if (other.top > top || (other.top == top && other.representative < representative)) {
    top = other.top;
    representative = other.representative;
  }
  hasVoxels = hasVoxels || other.hasVoxels;
}

std::vector<uint32_t> MergeParts::add(const SlabPart& part) {
  return add(openGraph(part));
}

std::vector<uint32_t> MergeParts::add(OpenGraph above) {
  const auto shift = uint32_t(open_.group.classes.size());
  const auto append = [](auto& all, const auto& some) {
    all.insert(all.end(), some.begin(), some.end());
  };
  for (MergeGroup::Edge& edge : above.group.edges) {
    edge.first += shift;
    edge.second += shift;
  }
  for (OpenGraph::Node& node : above.nodes) node.classIndex += shift;
  append(open_.group.classes, above.group.classes);
  append(open_.group.edges, above.group.edges);
  append(open_.about, above.about);
  number_.resize(open_.about.size(), kNone);
  joinNodes(above.nodes);

  const std::vector<uint32_t> after = contract(open_.group, rule_);
  follow(after);
  std::vector<uint32_t> numbers(after.begin() + shift, after.end());
  for (uint32_t& n : numbers) n = number_[n];
  dropDecided();
  return numbers;
}

/// A part as it is: each node a class, and any of them perhaps known already.
OpenGraph MergeParts::openGraph(const SlabPart& part) const {
  OpenGraph open;
  const std::vector<CriticalPoint>& nodes = part.graph.nodes;
  for (uint32_t i = 0; i < nodes.size(); ++i) {
    open.group.classes.push_back({nodes[i].squaredRadius, false});
    open.about.push_back(
        {nodes[i].position, nodes[i].squaredRadius, keepsEmpty_ || nodes[i].voxels > 0});
    open.nodes.push_back({nodes[i].position, i, part.startsBelow[i] != 0, part.goesOn[i] != 0});
  }
  for (const ManifoldGraph::Edge& edge : part.graph.edges) {
    const CriticalPoint &a = nodes[edge.first], &b = nodes[edge.second];
    const bool isCertain = rule_.mergesByAngle(a, b, edge.cellsTouch);
    if (!isCertain && !rule_.seesNeck(edge.saddleHeight)) continue;
    open.group.edges.push_back({edge.first, edge.second,
                                isCertain ? MergeGroup::kCertain : edge.saddleHeight, a.position,
                                b.position});
  }
  return open;
}

/// Those that both ranges know are one: the range below tells whether lower slabs know it, the one
/// above whether higher ones do. Keeps those that are still known beyond.
void MergeParts::joinNodes(const std::vector<OpenGraph::Node>& above) {
  using Node = OpenGraph::Node;
  std::vector<Node> joined;
  const auto keep = [&](const Node& node) {
    if (node.startsBelow || node.goesOn) joined.push_back(node);
  };
  auto known = open_.nodes.cbegin();
  for (const Node& node : above) {
    while (known != open_.nodes.cend() && known->position < node.position) keep(*known++);
    if (known == open_.nodes.cend() || known->position != node.position) {
      keep(node);
      continue;
    }
    open_.group.edges.push_back(
        {known->classIndex, node.classIndex, MergeGroup::kCertain, node.position, node.position});
    keep({node.position, known->classIndex, known->startsBelow, node.goesOn});
    ++known;
  }
  while (known != open_.nodes.cend()) keep(*known++);
  open_.nodes = std::move(joined);
  for (auto& c : open_.group.classes) c.isOpen = false;
  for (const Node& node : open_.nodes) open_.group.classes[node.classIndex].isOpen = true;
}

/// What is known of the classes, after they were contracted; gives numbers to all.
void MergeParts::follow(const std::vector<uint32_t>& after) {
  std::vector<About> about(open_.group.classes.size());
  std::vector<uint32_t> number(open_.group.classes.size(), kNone);
  for (size_t i = 0; i < after.size(); ++i) {
    about[after[i]].add(open_.about[i]);
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
  open_.about = std::move(about);
  number_ = std::move(number);
  for (OpenGraph::Node& node : open_.nodes) node.classIndex = after[node.classIndex];
}

/// Takes the classes out of the group that are neither open nor have an edge.
void MergeParts::dropDecided() {
  MergeGroup& group = open_.group;
  std::vector<char> stays(group.classes.size(), 0);
  for (size_t c = 0; c < stays.size(); ++c) stays[c] = group.classes[c].isOpen;
  for (const MergeGroup::Edge& edge : group.edges) stays[edge.first] = stays[edge.second] = 1;
  std::vector<uint32_t> place(stays.size(), kNone);
  uint32_t count = 0;
  for (size_t c = 0; c < stays.size(); ++c) {
    if (!stays[c]) continue;
    place[c] = count;
    group.classes[count] = group.classes[c];
    open_.about[count] = open_.about[c];
    number_[count++] = number_[c];
  }
  group.classes.resize(count);
  open_.about.resize(count);
  number_.resize(count);
  for (MergeGroup::Edge& edge : group.edges) {
    edge.first = place[edge.first];
    edge.second = place[edge.second];
  }
  for (OpenGraph::Node& node : open_.nodes) node.classIndex = place[node.classIndex];
}

OpenGraph MergeParts::handOver() {
  return std::exchange(open_, {});
}

std::vector<Coord> MergeParts::decided() {
  std::vector<char> isOpen(aboutNumber_.size(), 0);
  for (const uint32_t n : number_) isOpen[n] = 1;
  for (uint32_t n = 0; n < aboutNumber_.size(); ++n)
    if (numbers_.find(n) == n && !isOpen[n] && aboutNumber_[n].hasVoxels) decided_.push_back(n);
  parallelSort(decided_.begin(), decided_.end(), [&](uint32_t a, uint32_t b) {
    return aboutNumber_[a].representative < aboutNumber_[b].representative;
  });
  std::vector<Coord> representatives;
  for (const uint32_t n : decided_) representatives.push_back(aboutNumber_[n].representative);
  return representatives;
}

std::vector<uint32_t> MergeParts::grains(const std::vector<uint32_t>& ofDecided,
                                         const std::vector<uint32_t>& ofOpen) {
  std::vector<uint32_t> grain(aboutNumber_.size(), 0);
  for (size_t i = 0; i < decided_.size(); ++i) grain[decided_[i]] = ofDecided[i];
  for (size_t c = 0; c < ofOpen.size(); ++c) grain[number_[c]] = ofOpen[c];
  for (uint32_t n = 0; n < grain.size(); ++n) grain[n] = grain[numbers_.find(n)];
  return grain;
}

}  // namespace vdb_madf::detail
