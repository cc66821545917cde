// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/slabs/steps/slab_grains.h"

#include <map>
#include <numeric>
#include <utility>

#include "vdb_madf/base/detail/parallel.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/method/hierarchy.h"
#include "vdb_madf/method/join_small.h"
#include "vdb_madf/slabs/cuts/class_graph.h"
#include "vdb_madf/slabs/cuts/merge_parts.h"

namespace vdb_madf::detail {

namespace {

/// A binary tree over the members: after the join of a distance d, member r has merged the slabs of
/// members r to r + 2 d - 1, for each r that is a multiple of 2 d. What has left a member comes
/// back as the grains of the classes that it handed over.
class MergeTree {
 public:
  explicit MergeTree(SlabWork& work)
      : work_(work),
        member_(work.team.member()),
        count_(work.team.count()),
        joinsClasses_(work.options.merge.mode == MergeMode::score ||
                      work.options.merge.minGrain > 0),
        merging_(MergeRule(work.options.merge, work.facts.weights), joinsClasses_) {}

  std::vector<Coord> run(const std::function<SlabPart(size_t slab)>& part) {
    for (size_t s = work_.plan.firstOwn(); s < work_.plan.endOwn(); ++s) mergeSlab(s, part(s));
    int distance = 1;
    for (; distance < count_; distance *= 2) {
      if (isUpper(distance)) handOver(member_ - distance);
      work_.steps.exchange();
      if (isLower(distance)) join(member_ + distance);
    }
    if (work_.plan.isRoot()) numberGrains();
    while ((distance /= 2) > 0) {
      if (isLower(distance)) tellGrains(member_ + distance);
      work_.steps.exchange();
      if (isUpper(distance)) takeGrains();
    }
    const std::vector<uint32_t> grainOf = joinsClasses_ ? joinClasses() : std::vector<uint32_t>();
    for (size_t s = work_.plan.firstOwn(); s < work_.plan.endOwn(); ++s) {
      auto grains = work_.store.read(kClasses, s);
      for (uint32_t& grain : grains) {
        grain = grainOfClass_[grain];
        if (joinsClasses_) grain = grainOf[grain - 1];
      }
      if (joinsClasses_) grains = ofTerminals(work_.store.read(kGraphPart, s), grains);
      work_.store.write(kGrains, s, grains);
    }
    return std::move(representatives_);
  }

 private:
  // A join of a distance is one of a lower and an upper member.
  bool isLower(int distance) const {
    return member_ % (2 * distance) == 0 && member_ + distance < count_;
  }
  bool isUpper(int distance) const { return member_ % (2 * distance) == distance; }

  void mergeSlab(size_t s, const SlabPart& part) {
    if (work_.interrupter && work_.interrupter->wasInterrupted(75)) throw Interrupted();
    const std::vector<uint32_t> classOfNode = merging_.add(part);
    work_.store.write(kClasses, s, joinsClasses_ ? classOfNode : ofTerminals(part, classOfNode));
  }

  static std::vector<uint32_t> ofTerminals(const SlabPart& part,
                                           const std::vector<uint32_t>& ofNodes) {
    std::vector<uint32_t> values;
    values.reserve(part.nodeOf.size());
    for (const uint32_t node : part.nodeOf) values.push_back(ofNodes[node]);
    return values;
  }

  /// The grains so far are the classes that a hierarchy begins with, or those of the tests: few, so
  /// the root joins them. @return the grain of each
  std::vector<uint32_t> joinClasses() {
    for (size_t s = work_.plan.firstOwn(); s < work_.plan.endOwn(); ++s) {
      auto classes = work_.store.read(kClasses, s);  // of nodes
      for (uint32_t& c : classes) c = grainOfClass_[c] - 1;
      work_.store.send(kClassGraph, s, kRoot, classGraph(work_.store.read(kGraphPart, s), classes));
    }
    work_.steps.exchange();
    std::vector<uint32_t> grains;
    if (work_.plan.isRoot()) {
      JoinedClasses joined(representatives_);
      for (size_t s = 0; s < work_.plan.slabCount(); ++s)
        joined.add(work_.store.receive(kClassGraph, s, kRoot));
      const Merging merging = grainsOfClasses(joined.finish(work_.facts.weights, flatAxis()));
      grains.assign(merging.grainOfNode.begin(), merging.grainOfNode.end());
      std::vector<Coord> ofGrains;
      for (const uint32_t c : merging.representative) ofGrains.push_back(representatives_[c]);
      representatives_ = std::move(ofGrains);
    }
    return work_.store.broadcast(grains);
  }

  std::optional<int> flatAxis() const {
    const auto& domain = work_.facts.domain;
    return domain ? domain->flatAxis() : std::nullopt;
  }

  Merging grainsOfClasses(ManifoldGraph classes) const {
    const MergeOptions& how = work_.options.merge;
    if (how.mode == MergeMode::score && how.minGrain == 0)  // as merge(), in less memory
      return cut(mergeHierarchy(std::move(classes), how.strictness), how.strictness);
    if (how.mode == MergeMode::score) return merge(classes, how);
    std::vector<uint32_t> apart(classes.nodes.size());
    std::iota(apart.begin(), apart.end(), 0u);
    return joinSmallGrains(classes, mergeClasses(classes, apart), how.minGrain);
  }

  /// A message of a run by so many members.
  template <typename T>
  void send(int to, const Piece<T>& piece, int about, const AsIs<T>& value) {
    work_.store.give(to, piece.at(count_), size_t(about), value);
  }
  template <typename T>
  T receive(const Piece<T>& piece, int about) {
    T value = work_.store.read(piece.at(count_), size_t(about));
    work_.store.remove(piece.at(count_), size_t(about));
    return value;
  }

  void handOver(int lower) {
    const std::vector<Coord> decided = merging_.decided();
    send(lower, kMergeOpen, member_, merging_.handOver());
    send(0, kMergeDecided, member_, decided);
  }
  void join(int upper) { classesOf_[upper] = merging_.add(receive(kMergeOpen, upper)); }

  /// At the root: by their representatives.
  void numberGrains() {
    struct Grain {
      Coord representative;
      int member;
    };
    std::vector<Grain> all;
    const auto add = [&](const std::vector<Coord>& decided, int member) {
      for (const Coord& representative : decided) all.push_back({representative, member});
    };
    add(merging_.decided(), member_);
    for (int member = 1; member < count_; ++member) add(receive(kMergeDecided, member), member);
    parallelSort(all.begin(), all.end(), [](const Grain& a, const Grain& b) {
      return a.representative < b.representative;
    });
    std::vector<std::vector<uint32_t>> numbers;
    numbers.resize(size_t(count_));
    for (const Grain& grain : all) {
      representatives_.push_back(grain.representative);
      numbers[size_t(grain.member)].push_back(uint32_t(representatives_.size()));
    }
    for (int member = 1; member < count_; ++member)
      send(member, kMergeNumbers, member, numbers[size_t(member)]);
    // Nothing is open any more.
    grainOfClass_ = merging_.grains(numbers[0], {});
  }

  void tellGrains(int upper) {
    std::vector<uint32_t> grains;
    for (const uint32_t c : classesOf_.at(upper)) grains.push_back(grainOfClass_[c]);
    send(upper, kMergeGrains, upper, grains);
  }
  void takeGrains() {
    const std::vector<uint32_t> ofDecided = receive(kMergeNumbers, member_);
    grainOfClass_ = merging_.grains(ofDecided, receive(kMergeGrains, member_));
  }

  SlabWork& work_;
  const int member_, count_;
  const bool joinsClasses_;
  MergeParts merging_;
  std::map<int, std::vector<uint32_t>>
      classesOf_;  // by upper member: of the classes it handed over
  std::vector<uint32_t> grainOfClass_;
  std::vector<Coord> representatives_;
};

}  // namespace

std::vector<Coord> mergeParts(SlabWork& work, const std::function<SlabPart(size_t slab)>& part) {
  return MergeTree(work).run(part);
}

}  // namespace vdb_madf::detail
