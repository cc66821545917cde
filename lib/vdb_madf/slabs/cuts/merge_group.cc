// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/slabs/cuts/merge_group.h"

#include <algorithm>

#include "vdb_madf/base/detail/disjoint_sets.h"
#include "vdb_madf/base/detail/parallel.h"

namespace vdb_madf::detail {

namespace {

using Class = MergeGroup::Class;
using GroupEdge = MergeGroup::Edge;

/// The order in which merge() visits edges.
bool comesBefore(const GroupEdge& a, const GroupEdge& b) {
  if (a.height != b.height) return a.height > b.height;
  return a.lower != b.lower ? a.lower < b.lower : a.upper < b.upper;
}

class Contraction {
 public:
  Contraction(MergeGroup& group, const MergeRule& rule)
      : rule_(rule), classes_(group.classes), edges_(group.edges), sets_(group.classes.size()) {}

  std::vector<uint32_t> run() {
    parallelSort(edges_.begin(), edges_.end(), comesBefore);
    // What is not alive at its first edge never joins another class, and makes that with which it
    // is joined like it; so those that go on at least halve in each round.
    do dropEdges();
    while (joinClasses());
    return renumber();
  }

 private:
  /// Would the edge merge a class, be the other one as large as it may?
  bool isAlive(uint32_t c, const GroupEdge& edge) const {
    return rule_.mergesByNeck(edge.height, classes_[c].top);
  }

  /// Those within a class, those that merge neither of their classes, and those that close a ring
  /// of earlier ones.
  void dropEdges() {
    DisjointSets rings(classes_.size());
    size_t count = 0;
    for (GroupEdge edge : edges_) {
      edge.first = sets_.find(edge.first);
      edge.second = sets_.find(edge.second);
      if (!isAlive(edge.first, edge) && !isAlive(edge.second, edge)) continue;
      const uint32_t a = rings.find(edge.first), b = rings.find(edge.second);
      if (a == b) continue;
      rings.unite(a, b);
      edges_[count++] = edge;
    }
    edges_.resize(count);
  }

  /// Joins each class with that beyond its first edge, if it is alive there. @return were there
  /// any?
  bool joinClasses() {
    const size_t before = joins_;
    std::vector<char> hasEarlier(classes_.size(), 0);
    for (const GroupEdge& edge : edges_) {
      bool joins = edge.height == MergeGroup::kCertain;
      for (const uint32_t c : {edge.first, edge.second}) {
        if (!hasEarlier[c] && !classes_[c].isOpen && isAlive(c, edge)) joins = true;
        hasEarlier[c] = 1;
      }
      if (!joins) continue;
      sets_.unite(edge.first, edge.second);
      ++joins_;
    }
    for (uint32_t i = 0; i < classes_.size(); ++i) {
      Class& root = classes_[sets_.find(i)];
      root.top = std::max(root.top, classes_[i].top);
      root.isOpen = root.isOpen || classes_[i].isOpen;
    }
    return joins_ != before;
  }

  std::vector<uint32_t> renumber() {
    std::vector<uint32_t> classOf(classes_.size());
    uint32_t count = 0;
    for (uint32_t i = 0; i < classOf.size(); ++i) {
      const uint32_t root = sets_.find(i);  // the smallest of its set
      classOf[i] = root == i ? count++ : classOf[root];
      if (root == i) classes_[classOf[i]] = classes_[i];
    }
    classes_.resize(count);
    for (GroupEdge& edge : edges_) {
      edge.first = classOf[edge.first];
      edge.second = classOf[edge.second];
    }
    return classOf;
  }

  const MergeRule& rule_;
  std::vector<Class>& classes_;
  std::vector<GroupEdge>& edges_;
  DisjointSets sets_;
  size_t joins_ = 0;
};

}  // namespace

std::vector<uint32_t> contract(MergeGroup& group, const MergeRule& rule) {
  return Contraction(group, rule).run();
}

}  // namespace vdb_madf::detail
