// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/measure/detail/joined_areas.h"

#include <algorithm>
#include <limits>
#include <map>
#include <utility>

#include "vdb_madf/base/detail/parallel.h"
#include "vdb_madf/leaves/detail/voxels.h"
#include "vdb_madf/measure/detail/leaf_surface.h"

namespace vdb_madf::detail {

namespace {

using Areas = JoinedAreas::Areas;

constexpr uint32_t kNever = std::numeric_limits<uint32_t>::max();

void add(const Areas& from, int sign, Areas& to) {
  for (size_t i = 0; i < to.size(); ++i) to[i] += sign * from[i];
}

/// Which name a name gives way to, and when.
class Successors {
 public:
  Successors(const std::vector<uint32_t>& names, const std::vector<NamedJoin>& joins)
      : joins_(joins) {
    uint32_t last = 0;
    for (const uint32_t name : names) last = std::max(last, name);
    for (const NamedJoin& join : joins) last = std::max({last, join.kept, join.gone});
    joinOf_.assign(size_t(last) + 1, kNever);
    for (size_t i = 0; i < joins.size(); ++i) joinOf_[joins[i].gone] = uint32_t(i);
  }

  uint32_t joinOf(uint32_t name) const { return joinOf_[name]; }
  uint32_t keptBy(uint32_t join) const { return joins_[join].kept; }

 private:
  const std::vector<NamedJoin>& joins_;
  std::vector<uint32_t> joinOf_;
};

/// What one thread sees.
class LeafJoiner {
 public:
  LeafJoiner(const LabelLeaves& labels, const std::optional<Domain>& openDomain,
             const VoxelShape& voxel, const std::vector<uint32_t>& nameOfLabel,
             const Successors& successors)
      : nameOfLabel_(nameOfLabel), successors_(successors), surface_(labels, openDomain, voxel) {}

  std::map<std::pair<int32_t, int32_t>, JoinedAreas::Contact> contacts;
  std::map<std::pair<uint32_t, uint32_t>, Areas> changes;
  std::map<uint32_t, int64_t> freeAreas;  // by join

  void add(size_t leaf) {
    surface_.measure(leaf);
    begin();
    while (grains_.size() > 1) {
      const auto next =
          std::min_element(grains_.begin(), grains_.end(), [&](const Grain& a, const Grain& b) {
            return successors_.joinOf(a.name) < successors_.joinOf(b.name);
          });
      const uint32_t join = successors_.joinOf(next->name);
      if (join == kNever) break;
      const uint32_t kept = successors_.keptBy(join);
      const auto other = std::find_if(grains_.begin(), grains_.end(),
                                      [&](const Grain& grain) { return grain.name == kept; });
      if (other == grains_.end()) {
        next->name = kept;
        continue;
      }
      unite(join, *other, *next);
      grains_.erase(next);
    }
  }

 private:
  /// One in or around the leaf.
  struct Grain {
    uint32_t name;
    int32_t label;     // that the surfaces know it by
    int64_t freeArea;  // in the leaf
  };
  struct Pair {
    int32_t first, second;  // labels
    Areas areas;
  };

  void begin() {
    grains_.clear();
    pairs_.clear();
    for (const int32_t label : surface_.labels())
      grains_.push_back({nameOfLabel_[size_t(label) - 1], label, 0});
    for (const LeafSurface::Free& free : surface_.free())
      for (Grain& grain : grains_)
        if (grain.label == free.label) grain.freeArea = free.area;
    for (const LeafSurface::Shared& shared : surface_.shared()) {
      pairs_.push_back({shared.first, shared.second, shared.areas});
      JoinedAreas::Contact& contact = contacts[{shared.first, shared.second}];
      detail::add(shared.areas, 1, contact.areas);
      for (const InterfaceFace& face : shared.faces) contact.faces[size_t(face.axis)] += face.sign;
    }
  }

  void unite(uint32_t join, Grain& kept, const Grain& gone) {
    surface_.join(kept.label, gone.label);
    int64_t freeArea = 0;
    for (const LeafSurface::Free& free : surface_.free()) freeArea += free.area;
    if (const int64_t more = freeArea - kept.freeArea - gone.freeArea) freeAreas[join] += more;
    kept.freeArea = freeArea;
    // Pairs of the two are those of the union, and as large as it is measured to be.
    std::map<int32_t, Areas> more;  // by the other's label
    std::vector<Pair> rest;
    for (const Pair& pair : pairs_) {
      const bool first = pair.first == kept.label || pair.first == gone.label;
      const bool second = pair.second == kept.label || pair.second == gone.label;
      if (!first && !second)
        rest.push_back(pair);
      else if (first != second)
        detail::add(pair.areas, -1, more[first ? pair.second : pair.first]);
    }
    for (const LeafSurface::Shared& shared : surface_.shared()) {
      detail::add(shared.areas, 1, more[shared.first == kept.label ? shared.second : shared.first]);
      rest.push_back({shared.first, shared.second, shared.areas});
    }
    pairs_.swap(rest);
    for (const auto& [label, areas] : more)
      if (areas != Areas{}) detail::add(areas, 1, changes[{join, nameOf(label)}]);
  }

  uint32_t nameOf(int32_t label) const {
    return std::find_if(grains_.begin(), grains_.end(),
                        [label = label](const Grain& grain) { return grain.label == label; })
        ->name;
  }

  const std::vector<uint32_t>& nameOfLabel_;
  const Successors& successors_;
  LeafSurface surface_;
  std::vector<Grain> grains_;
  std::vector<Pair> pairs_;  // that have a part in the leaf
};

}  // namespace

JoinedAreasCounter::JoinedAreasCounter(const std::optional<Domain>& openDomain,
                                       const VoxelShape& voxel, std::vector<uint32_t> nameOfLabel,
                                       std::vector<NamedJoin> joins)
    : openDomain_(openDomain),
      voxel_(voxel),
      nameOfLabel_(std::move(nameOfLabel)),
      joins_(std::move(joins)),
      freeAreas_(joins_.size(), 0) {}

void JoinedAreasCounter::add(const LabelLeaves& labels, const LeafLayers& layers,
                             Interrupter* interrupter) {
  const Successors successors(nameOfLabel_, joins_);
  PerThread<LeafJoiner> joiners(
      [&] { return LeafJoiner(labels, openDomain_, voxel_, nameOfLabel_, successors); });
  const LeafIndex& index = labels.index();
  parallelFor(index.leafCount(), kLeafGrain, interrupter, [&](size_t begin, size_t end) {
    LeafJoiner& joiner = joiners.local();
    for (size_t leaf = begin; leaf < end; ++leaf)
      if (layers.hold(index.origin(leaf))) joiner.add(leaf);
  });
  for (const LeafJoiner& joiner : joiners) {
    for (const auto& [pair, contact] : joiner.contacts) {
      detail::add(contact.areas, 1, contacts_[pair].areas);
      detail::add(contact.faces, 1, contacts_[pair].faces);
    }
    for (const auto& [pair, areas] : joiner.changes) detail::add(areas, 1, changes_[pair]);
    for (const auto& [join, area] : joiner.freeAreas) freeAreas_[join] += area;
  }
}

JoinedAreas JoinedAreasCounter::areas() const {
  JoinedAreas result;
  result.freeAreas = freeAreas_;
  for (const auto& [pair, contact] : contacts_)
    result.contacts.push_back({pair.first, pair.second, contact.areas, contact.faces});
  for (const auto& [pair, areas] : changes_)
    if (areas != Areas{}) result.changes.push_back({pair.first, pair.second, areas});
  return result;
}

}  // namespace vdb_madf::detail
