// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/method/hierarchy.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <string>
#include <tuple>
#include <unordered_map>
#include <utility>

#include "vdb_madf/base/detail/disjoint_sets.h"
#include "vdb_madf/base/detail/parallel.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/method/detail/join_score.h"
#include "vdb_madf/method/detail/merge_classes.h"

namespace vdb_madf {

namespace {

using detail::JoinScore;

int32_t unitsOf(double score) {
  return int32_t(std::lround(score * Hierarchy::kUnitsOfScore));
}

/// Counts saturate: what is larger is no different to a score.
int64_t addVoxels(int64_t some, int64_t more) {
  const int64_t most = JoinScore::kMaxVoxels;
  return std::min(some + std::clamp<int64_t>(more, 0, most), most);
}

/// The classes to begin with. Nodes are in lexicographic order, so the first of the largest is the
/// representative.
Hierarchy unjoined(const ManifoldGraph& graph, double lowest) {
  if (!(std::abs(lowest) <= kMaxStrictness))
    throw InvalidInput("the lowest strictness must lie between -200000 and 200000");
  Hierarchy hierarchy;
  hierarchy.lowest = lowest;
  MergeOptions maxima;
  maxima.mode = MergeMode::score;
  const std::vector<uint32_t> root = detail::mergedClasses(graph, maxima);
  const auto count = uint32_t(graph.nodes.size());
  std::vector<uint32_t> best(root);
  for (uint32_t i = 0; i < count; ++i)
    if (graph.nodes[i].squaredRadius > graph.nodes[best[root[i]]].squaredRadius) best[root[i]] = i;
  size_t classes = 0;
  for (uint32_t i = 0; i < count; ++i) classes += best[root[i]] == i;
  hierarchy.classes.reserve(classes);
  std::vector<uint32_t> classOfRoot(count);
  for (uint32_t i = 0; i < count; ++i) {
    if (best[root[i]] != i) continue;
    classOfRoot[root[i]] = uint32_t(hierarchy.classes.size());
    hierarchy.classes.push_back({i, graph.nodes[i].squaredRadius, 0, 0});
  }
  hierarchy.classOfNode.reserve(count);
  for (uint32_t i = 0; i < count; ++i) {
    hierarchy.classOfNode.push_back(classOfRoot[root[i]]);
    Hierarchy::Class& all = hierarchy.classes[hierarchy.classOfNode[i]];
    all.voxels = addVoxels(all.voxels, graph.nodes[i].voxels);
    all.cavityVoxels = addVoxels(all.cavityVoxels, graph.nodes[i].cavityVoxels);
  }
  return hierarchy;
}

/// The contacts of a cluster, by the cluster on their other side, in no order. Most have a handful,
/// for which a list takes a third of a map's memory; some have thousands.
class Neighbors {
 public:
  size_t size() const { return items_.size(); }
  auto begin() const { return items_.begin(); }
  auto end() const { return items_.end(); }
  void reserve(size_t count) { items_.reserve(count); }

  /// @return the contact with the other cluster, and true if it is this one
  std::pair<uint32_t, bool> emplace(uint32_t other, uint32_t contact) {
    const size_t place = find(other);
    if (place < size()) return {items_[place].second, false};
    items_.emplace_back(other, contact);
    if (places_) {
      places_->emplace(other, uint32_t(place));
    } else if (size() > kFew) {
      places_ = std::make_unique<std::unordered_map<uint32_t, uint32_t>>();
      for (size_t i = 0; i < size(); ++i) places_->emplace(items_[i].first, uint32_t(i));
    }
    return {contact, true};
  }
  /// Nothing if it is not there.
  void erase(uint32_t other) {
    const size_t place = find(other);
    if (place == size()) return;
    items_[place] = items_.back();
    items_.pop_back();
    if (!places_) return;
    if (place < size()) (*places_)[items_[place].first] = uint32_t(place);
    places_->erase(other);
  }

 private:
  static constexpr size_t kFew = 32;

  size_t find(uint32_t other) const {
    if (places_) {
      const auto known = places_->find(other);
      return known == places_->end() ? size() : known->second;
    }
    const auto isIt = [&](const auto& item) { return item.first == other; };
    return size_t(std::find_if(items_.begin(), items_.end(), isIt) - items_.begin());
  }

  std::vector<std::pair<uint32_t, uint32_t>> items_;
  std::unique_ptr<std::unordered_map<uint32_t, uint32_t>> places_;  // in items_, if they are many
};

/// Joins the pair of largest score, again and again.
///
/// Each pair waits in the heap of its b, under the score less b's volume term; b takes a turn with
/// its first pair, unless none of its pairs can reach the lowest score. When a or b has grown, but
/// has its m, s and name still, what was computed of its pairs is a bound, for it can only have
/// become smaller (JoinScore): that of the first one is computed anew when it is its turn. So a
/// class that joins thousands of small neighbors does not look at all others each time, but only at
/// those that it has outgrown (`larger`).
///
/// Wherever there is a score 1 <= h < m: an edge with 0 < h that had not h < m of both its classes
/// has joined them before (unjoined), and m only grows.
class Joining {
 public:
  Joining(const ManifoldGraph& graph, Hierarchy& hierarchy)
      : score_(graph.weights, graph.flatAxis),
        lowest_(unitsOf(hierarchy.lowest)),
        hierarchy_(hierarchy) {
    addContacts(graph.edges);
    clusters_.reserve(hierarchy.classes.size());
    for (uint32_t c = 0; c < hierarchy.classes.size(); ++c) {
      const Hierarchy::Class& one = hierarchy.classes[c];
      const int64_t voxels = addVoxels(one.voxels, one.cavityVoxels);
      clusters_.push_back({voxels, {std::max<int64_t>(1, voxels), one.top, 0}, c});
    }
    for (size_t i = 0; i < graph.nodes.size(); ++i) {
      int32_t& sure = clusters_[hierarchy.classOfNode[i]].size.sure;
      sure = std::max(sure, graph.nodes[i].squaredRadius - graph.nodes[i].doubt);
    }
  }

  void run() {
    linkContacts();
    scoreAll();
    while (!turns_.empty()) {
      const Waiting turn = turns_.front();
      Cluster& b = clusters_[turn.of];
      if (turn.version == b.version) {
        const Waiting first = b.pairs.front();
        const bool isNew = !isOld(first);
        const Pair pair = isNew ? pairOf(first.of) : Pair();
        if (isNew && first.score == restOfScore(pair, first.of)) {
          pop(turns_);
          join(first.of, pair, turn);
          continue;
        }
        pop(b.pairs);
        pop(turns_);
        if (isNew) score(first.of, turn.of);
        takeTurn(turn.of);
      } else {
        pop(turns_);
      }
    }
  }

 private:
  static constexpr size_t kContactsPerChunk = 1 << 14;

  /// What waits for its score to be the largest: a pair of clusters, named by its contact, or a
  /// cluster with its first pair. It is out of date if that has another version by now.
  struct Waiting {
    int32_t score;
    uint32_t first, second;  ///< the names of the pair, ascending
    uint32_t of, version;
    bool operator<(const Waiting& o) const {  // the first is the largest in a heap
      return score != o.score ? score < o.score
                              : std::tie(first, second) > std::tie(o.first, o.second);
    }
  };
  struct Contact {
    uint32_t one, two;  ///< clusters
    int32_t height;
    uint32_t faces;  ///< up to JoinScore::kMaxFaces
    uint32_t version = 0;
    bool operator<(const Contact& o) const { return std::tie(one, two) < std::tie(o.one, o.two); }
  };
  /// A pair whose score may gain once its a has as many voxels as its b.
  struct Larger {
    int64_t voxels;  ///< of b, which may have grown
    uint32_t of, version;
    bool operator<(const Larger& o) const { return voxels > o.voxels; }  // the first is the least
  };
  struct Cluster {
    int64_t voxels = 0;
    detail::ScoredClass size;
    uint32_t name = 0;  ///< the class of its representative
    uint32_t version = 0;
    Neighbors contactWith = {};
    std::vector<Waiting> pairs = {};  ///< a heap: those of which it is b
    std::vector<Larger> larger = {};  ///< a heap: those of which it is a
  };
  struct Pair {
    uint32_t a = 0, b = 0;
  };

  template <typename Item>
  static void push(std::vector<Item>& heap, const Item& item) {
    heap.push_back(item);
    std::push_heap(heap.begin(), heap.end());
  }
  template <typename Item>
  static void pop(std::vector<Item>& heap) {
    std::pop_heap(heap.begin(), heap.end());
    heap.pop_back();
  }

  void addContacts(const std::vector<ManifoldGraph::Edge>& edges) {
    const std::vector<uint32_t>& classOf = hierarchy_.classOfNode;
    contacts_ = detail::parallelCollect<Contact>(
        edges.size(), kContactsPerChunk, nullptr, [&](size_t i, std::vector<Contact>& some) {
          const ManifoldGraph::Edge& edge = edges[i];
          const auto [one, two] = std::minmax(classOf[edge.first], classOf[edge.second]);
          if (one != two) some.push_back({one, two, edge.saddleHeight, facesOf(edge)});
        });
    detail::parallelSort(contacts_.begin(), contacts_.end(), std::less<>());
    size_t count = 0;
    for (const Contact& contact : contacts_)
      if (count > 0 && !(contacts_[count - 1] < contact))
        widen(contacts_[count - 1], contact);
      else
        contacts_[count++] = contact;
    contacts_.resize(count);
  }

  void linkContacts() {
    std::vector<uint32_t> count(clusters_.size(), 0);
    for (const Contact& contact : contacts_) {
      ++count[contact.one];
      ++count[contact.two];
    }
    for (uint32_t c = 0; c < clusters_.size(); ++c) clusters_[c].contactWith.reserve(count[c]);
    for (uint32_t c = 0; c < contacts_.size(); ++c) {
      clusters_[contacts_[c].one].contactWith.emplace(contacts_[c].two, c);
      clusters_[contacts_[c].two].contactWith.emplace(contacts_[c].one, c);
    }
  }

  static uint32_t facesOf(const ManifoldGraph::Edge& edge) {
    return uint32_t(std::clamp<int64_t>(edge.contactFaces, 0, JoinScore::kMaxFaces));
  }

  static void widen(Contact& contact, const Contact& more) {
    contact.faces = uint32_t(std::min(int64_t(contact.faces) + more.faces, JoinScore::kMaxFaces));
    contact.height = std::max(contact.height, more.height);
  }

  Pair pairOf(uint32_t contact) const {
    const uint32_t one = contacts_[contact].one, two = contacts_[contact].two;
    const auto isSmaller = [](const Cluster& x, const Cluster& y) {
      if (x.size.top != y.size.top) return x.size.top < y.size.top;
      if (x.size.voxels != y.size.voxels) return x.size.voxels < y.size.voxels;
      return x.name > y.name;
    };
    return isSmaller(clusters_[one], clusters_[two]) ? Pair{one, two} : Pair{two, one};
  }

  int32_t volumeTerm(const Cluster& b) const { return score_.volumeTerm(b.size.voxels); }
  int32_t restOfScore(const Pair& pair, uint32_t contact) const {
    const Cluster &a = clusters_[pair.a], &b = clusters_[pair.b];
    const Contact& c = contacts_[contact];
    return score_(a.size, b.size, c.faces, c.height) - volumeTerm(b);
  }

  void scoreAll() {
    std::vector<int32_t> rest(contacts_.size());
    detail::parallelForEach(rest.size(), kContactsPerChunk, nullptr, [&](size_t c) {
      if (contacts_[c].height > 0) rest[c] = restOfScore(pairOf(uint32_t(c)), uint32_t(c));
    });
    std::vector<uint32_t> count(clusters_.size(), 0);
    for (uint32_t c = 0; c < rest.size(); ++c)
      if (contacts_[c].height > 0) ++count[pairOf(c).b];
    for (uint32_t c = 0; c < clusters_.size(); ++c) clusters_[c].pairs.reserve(count[c]);
    for (uint32_t c = 0; c < rest.size(); ++c)
      if (contacts_[c].height > 0) wait(c, pairOf(c), rest[c]);
    for (uint32_t c = 0; c < clusters_.size(); ++c) takeTurn(c);
  }

  Waiting waiting(int32_t score, uint32_t contact) const {
    const Contact& c = contacts_[contact];
    const auto [first, second] = std::minmax(clusters_[c.one].name, clusters_[c.two].name);
    return {score, first, second, contact, c.version};
  }

  void wait(uint32_t contact, const Pair& pair, int32_t rest) {
    push(clusters_[pair.b].pairs, waiting(rest, contact));
    const detail::ScoredClass &a = clusters_[pair.a].size, &b = clusters_[pair.b].size;
    if (a.top == b.top || (b.sure < b.top && b.voxels > a.voxels))
      push(clusters_[pair.a].larger, {b.voxels, contact, contacts_[contact].version});
  }

  /// Lets the pair of a contact wait anew, if it has a score.
  /// @param takesTurn a cluster that takes its turn afterwards, and none here
  void score(uint32_t contact, uint32_t takesTurn) {
    ++contacts_[contact].version;
    if (contacts_[contact].height <= 0) return;
    const Pair pair = pairOf(contact);
    wait(contact, pair, restOfScore(pair, contact));
    if (pair.b != takesTurn && clusters_[pair.b].pairs.front().of == contact) takeTurn(pair.b);
  }

  bool isOld(const Waiting& pair) const { return contacts_[pair.of].version != pair.version; }

  void takeTurn(uint32_t cluster) {
    Cluster& b = clusters_[cluster];
    ++b.version;
    while (!b.pairs.empty() && isOld(b.pairs.front())) pop(b.pairs);
    if (b.pairs.empty()) return;
    Waiting turn = b.pairs.front();
    turn.score += volumeTerm(b);
    if (turn.score < lowest_) return;
    turn.of = cluster;
    turn.version = b.version;
    push(turns_, turn);
  }

  void join(uint32_t contact, const Pair& pair, const Waiting& turn) {
    hierarchy_.joins.push_back({turn.first, turn.second, turn.score});
    const bool isLarger =
        clusters_[pair.a].contactWith.size() > clusters_[pair.b].contactWith.size();
    const uint32_t keptIndex = isLarger ? pair.a : pair.b, goneIndex = isLarger ? pair.b : pair.a;
    ++contacts_[contact].version;
    Cluster gone;
    std::swap(gone, clusters_[goneIndex]);
    clusters_[goneIndex].version = gone.version + 1;  // its turn never comes
    Cluster& kept = clusters_[keptIndex];
    const uint32_t nameBefore = kept.name;
    const int32_t sureBefore = kept.size.sure;
    if (gone.size.top > kept.size.top || (gone.size.top == kept.size.top && gone.name < kept.name))
      kept.name = gone.name;
    kept.size.top = std::max(kept.size.top, gone.size.top);
    kept.size.sure = std::max(kept.size.sure, gone.size.sure);
    kept.voxels = addVoxels(kept.voxels, gone.voxels);
    kept.size.voxels = std::max<int64_t>(1, kept.voxels);

    kept.contactWith.erase(goneIndex);
    gone.contactWith.erase(keptIndex);
    std::vector<uint32_t> changed;
    for (const auto& [other, its] : gone.contactWith)
      changed.push_back(moveContact(its, other, goneIndex, keptIndex));
    // Another name, another order of equal scores, and maybe another m; else, if what is sure of m
    // is the same, only what touches the part that came, and what it has outgrown, is new.
    if (kept.name != nameBefore || kept.size.sure != sureBefore) {
      changed.clear();
      for (const auto& [other, its] : kept.contactWith) changed.push_back(its);
      kept.larger.clear();
    } else {
      for (const uint32_t c : changed) ++contacts_[c].version;
      for (; !kept.larger.empty() && kept.larger.front().voxels <= kept.size.voxels;
           pop(kept.larger))
        if (contacts_[kept.larger.front().of].version == kept.larger.front().version)
          changed.push_back(kept.larger.front().of);
    }
    for (const uint32_t c : changed) score(c, keptIndex);
    takeTurn(keptIndex);
  }

  /// @return the contact that the other cluster has with the kept one
  uint32_t moveContact(uint32_t contact, uint32_t other, uint32_t gone, uint32_t kept) {
    clusters_[other].contactWith.erase(gone);
    const auto [known, isNew] = clusters_[kept].contactWith.emplace(other, contact);
    Contact& moved = contacts_[contact];
    if (isNew) {
      (moved.one == gone ? moved.one : moved.two) = kept;
      clusters_[other].contactWith.emplace(kept, contact);
    } else {
      ++moved.version;
      widen(contacts_[known], moved);
    }
    return known;
  }

  JoinScore score_;
  int32_t lowest_;
  Hierarchy& hierarchy_;
  std::vector<Cluster> clusters_;
  std::vector<Contact> contacts_;
  std::vector<Waiting> turns_;  // a heap: of clusters
};

}  // namespace

Hierarchy mergeHierarchy(const ManifoldGraph& graph, double lowest) {
  Hierarchy hierarchy = unjoined(graph, lowest);
  Joining(graph, hierarchy).run();
  return hierarchy;
}

Hierarchy mergeHierarchy(ManifoldGraph&& graph, double lowest) {
  Hierarchy hierarchy = unjoined(graph, lowest);
  Joining joining(graph, hierarchy);
  graph = {};
  joining.run();
  return hierarchy;
}

std::vector<JoinedGrains> joinedGrains(const Hierarchy& hierarchy) {
  std::vector<Hierarchy::Class> classes = hierarchy.classes;
  int64_t grains = std::count_if(classes.begin(), classes.end(),
                                 [](const Hierarchy::Class& c) { return c.voxels > 0; });
  std::vector<JoinedGrains> all;
  all.reserve(hierarchy.joins.size());
  for (const Hierarchy::Join& join : hierarchy.joins) {
    Hierarchy::Class &first = classes[join.first], &second = classes[join.second];
    if (first.voxels > 0 && second.voxels > 0) --grains;
    JoinedGrains row;
    row.first = first.representative;
    row.second = second.representative;
    row.firstVoxels = first.voxels;
    row.secondVoxels = second.voxels;
    row.score = double(join.score) / Hierarchy::kUnitsOfScore;
    row.strictness = all.empty() ? row.score : std::min(row.score, all.back().strictness);
    row.grains = grains;
    all.push_back(row);
    Hierarchy::Class& kept = second.top > first.top ? second : first;
    kept.voxels = addVoxels(row.firstVoxels, row.secondVoxels);
  }
  return all;
}

size_t joinsAt(const Hierarchy& hierarchy, double strictness) {
  if (!(strictness >= hierarchy.lowest && strictness <= kMaxStrictness))
    throw InvalidInput("the hierarchy has no grains at the strictness " +
                       std::to_string(strictness) + ": it must lie between " +
                       std::to_string(hierarchy.lowest) + " and 200000");
  const std::vector<Hierarchy::Join>& joins = hierarchy.joins;
  const int32_t least = unitsOf(strictness);
  const auto end = std::find_if(joins.begin(), joins.end(), [least](const Hierarchy::Join& join) {
    return join.score < least;
  });
  return size_t(end - joins.begin());
}

Merging cut(const Hierarchy& hierarchy, double strictness) {
  const std::vector<Hierarchy::Class>& classes = hierarchy.classes;
  detail::DisjointSets sets(classes.size());
  const size_t joins = joinsAt(hierarchy, strictness);
  for (size_t i = 0; i < joins; ++i)
    sets.unite(hierarchy.joins[i].first, hierarchy.joins[i].second);
  std::vector<uint32_t> best(classes.size());
  std::vector<char> hasVoxels(classes.size(), 0);
  for (uint32_t c = 0; c < classes.size(); ++c) {
    const uint32_t root = sets.find(c);  // the first of its set
    if (root == c || classes[c].top > classes[best[root]].top) best[root] = c;
    if (classes[c].voxels > 0) hasVoxels[root] = 1;
  }
  Merging merging;
  std::vector<int32_t> grainOfRoot(classes.size(), 0);
  for (uint32_t c = 0; c < classes.size(); ++c) {
    const uint32_t root = sets.find(c);
    if (best[root] != c || !hasVoxels[root]) continue;
    merging.representative.push_back(classes[c].representative);
    grainOfRoot[root] = int32_t(merging.representative.size());
  }
  merging.grainOfNode.reserve(hierarchy.classOfNode.size());
  for (const uint32_t c : hierarchy.classOfNode)
    merging.grainOfNode.push_back(grainOfRoot[sets.find(c)]);
  return merging;
}

std::vector<int64_t> grainVoxels(const Hierarchy& hierarchy, const Merging& merging) {
  std::vector<int64_t> voxels(merging.representative.size(), 0);
  for (const Hierarchy::Class& c : hierarchy.classes)
    if (const int32_t grain = merging.grainOfNode[c.representative])
      voxels[size_t(grain) - 1] += c.voxels;
  return voxels;
}

}  // namespace vdb_madf
