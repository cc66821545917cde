// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

// contract() on random graphs that are cut into groups, and MergeParts on such that are cut into
// parts, against the definition of merging, edge after edge, written here again.
//
// The random comparisons read from the environment VDB_MADF_GRAPHS (how many) and VDB_MADF_SEED
// (the first).

#include "vdb_madf/slabs/cuts/merge_group.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>
#include <sstream>
#include <tuple>
#include <vector>

#include "support/catch.h"
#include "support/merge_tree.h"
#include "support/random_volume.h"
#include "support/runs.h"

namespace {

using namespace vdb_madf;
using namespace vdb_madf::test;
using detail::MergeGroup;
using detail::MergeRule;
using detail::SlabPart;

/// What one group knows of an edge.
struct Part {
  uint32_t first, second;
  int height;
  bool cellsTouch;
  int group;
};

struct Case {
  std::vector<CriticalPoint> nodes;  // lexicographic
  std::vector<Part> parts;
  std::vector<int> owner;  // of each node, a group
  int groups = 1;
  MergeOptions options;
  VoxelWeights weights{};
};

Case randomGraph(uint64_t seed) {
  Rng rng(seed);
  Case c;
  c.groups = rng.between(1, 5);
  const double thetas[] = {-1, -0.9, -0.8, -0.5, 0, 0.5, 1};
  c.options = {MergeMode(rng.below(3)), 11, thetas[rng.below(7)],
               rng.chance(0.5) ? 0 : rng.between(1, 12), Adjacency(rng.below(2))};
  if (rng.chance(0.2)) c.weights = {rng.between(1, 9), rng.between(1, 9), rng.between(1, 9)};
  // Few radii and heights: many ties.
  const int count = rng.between(1, 12), radii = rng.between(1, 24), side = rng.between(3, 12);
  std::vector<Coord> places;
  for (int i = 0; i < count; ++i)
    places.push_back({rng.below(side), rng.below(side), rng.below(side)});
  std::sort(places.begin(), places.end());
  places.erase(std::unique(places.begin(), places.end()), places.end());
  for (const Coord& p : places) {
    c.nodes.push_back({p, 1 + rng.below(radii), 1});
    c.owner.push_back(rng.below(c.groups));
  }
  const double density = rng.unit(), split = rng.unit(), high = rng.chance(0.2) ? 0.5 : 0;
  for (uint32_t a = 0; a < c.nodes.size(); ++a)
    for (uint32_t b = a + 1; b < c.nodes.size(); ++b) {
      if (!rng.chance(density)) continue;
      const int lower = std::min(c.nodes[a].squaredRadius, c.nodes[b].squaredRadius);
      do
        c.parts.push_back({a, b, rng.chance(high) ? lower + rng.below(9) : rng.between(-1, lower),
                           rng.chance(0.5), rng.below(c.groups)});
      while (rng.chance(split));
    }
  return c;
}

/// The classes of the nodes, each named by its first: all parts of an edge together, one after the
/// other.
std::vector<uint32_t> mergedByDefinition(const Case& c) {
  struct Edge {
    int height;
    bool cellsTouch;
  };
  const size_t count = c.nodes.size();
  std::vector<std::vector<Edge>> edges(count, std::vector<Edge>(count, {-1000, false}));
  std::vector<std::tuple<int, uint32_t, uint32_t>> necks;
  for (const Part& part : c.parts) {
    Edge& edge = edges[part.first][part.second];
    if (edge.height == -1000) necks.emplace_back(0, part.first, part.second);
    edge = {std::max(edge.height, part.height), edge.cellsTouch || part.cellsTouch};
  }
  std::vector<uint32_t> classOf(count);
  std::iota(classOf.begin(), classOf.end(), 0u);
  const auto merge = [&](uint32_t a, uint32_t b) {
    std::replace(classOf.begin(), classOf.end(), std::max(a, b), std::min(a, b));
  };
  const double theta = c.options.theta;
  const auto weight = [&](int axis) { return int64_t(c.weights[size_t(axis)]); };
  for (auto& [height, a, b] : necks) {
    height = -edges[a][b].height;  // ascending order: descending height
    if (c.options.mode == MergeMode::neck) continue;
    if (c.options.adjacency == Adjacency::cell && !edges[a][b].cellsTouch) continue;
    int64_t apart = -int64_t(c.nodes[a].squaredRadius) - c.nodes[b].squaredRadius;
    for (int axis = 0; axis < 3; ++axis) {
      const int64_t d = c.nodes[a].position[axis] - c.nodes[b].position[axis];
      apart += weight(axis) * d * d;
    }
    const double roots =
        std::sqrt(double(int64_t(c.nodes[a].squaredRadius) * c.nodes[b].squaredRadius));
    if (double(apart) / (2 * roots) < theta) merge(classOf[a], classOf[b]);
  }
  if (c.options.mode == MergeMode::angle) return classOf;
  std::sort(necks.begin(), necks.end());
  for (const auto& [negative, a, b] : necks) {
    const int64_t h = -negative, k = c.options.delta;
    if (h <= 0 || classOf[a] == classOf[b]) continue;
    std::array<int64_t, 2> top{0, 0};
    for (size_t i = 0; i < count; ++i)
      for (const size_t side : {0u, 1u})
        if (classOf[i] == classOf[side == 0 ? a : b])
          top[side] = std::max<int64_t>(top[side], c.nodes[i].squaredRadius);
    const int64_t m = std::min(top[0], top[1]);
    const int64_t least = std::min({weight(0), weight(1), weight(2)});
    const int64_t l = 64 * (m - h) - k * k * least;
    const bool within = k > 0 && (l < 0 || l * l < 256 * k * k * least * h);
    if (double(h) >= (1 - theta) / 2 * double(m) || within) merge(classOf[a], classOf[b]);
  }
  return classOf;
}

/// A group with the nodes that it knows.
struct Known {
  MergeGroup group;
  std::vector<int> classOf;  // of each node; -1: not known here
  uint32_t groups = 0;       // those in it, a bit for each
};

class Contractor {
 public:
  explicit Contractor(const Case& c)
      : case_(c), rule_(c.options, c.weights), knownBy_(c.nodes.size(), 0) {}

  /// The classes of the nodes, each named by its first; empty if edges are left then, or before
  /// some that close a ring or are certain.
  std::vector<uint32_t> run(Rng& rng) {
    std::vector<Known> all;
    for (int g = 0; g < case_.groups; ++g) all.push_back(knownTo(g, rng));
    while (true) {
      for (Known& known : all)
        if (all.size() == 1 || rng.chance(0.8)) shrink(known);
      if (all.size() == 1) break;
      std::swap(all[size_t(rng.below(int(all.size())))], all.back());
      const Known last = std::move(all.back());
      all.pop_back();
      join(all[size_t(rng.below(int(all.size())))], last);
    }
    if (hasNeedless_ || !all[0].group.edges.empty()) return {};
    std::vector<uint32_t> first(all[0].group.classes.size(), ~0u), classOf;
    for (uint32_t i = 0; i < case_.nodes.size(); ++i) {
      uint32_t& name = first[size_t(all[0].classOf[i])];
      name = std::min(name, i);
      classOf.push_back(name);
    }
    return classOf;
  }

 private:
  Known knownTo(int g, Rng& rng) {
    Known known;
    known.groups = 1u << g;
    known.classOf.assign(case_.nodes.size(), -1);
    const auto classOf = [&](uint32_t node) {
      if (known.classOf[node] < 0) {
        known.classOf[node] = int(known.group.classes.size());
        // Only the owner has to know D; others may know that it is not less.
        const int32_t d = case_.nodes[node].squaredRadius;
        known.group.classes.push_back({case_.owner[node] == g ? d : rng.between(0, d), false});
        knownBy_[node] |= known.groups;
      }
      return uint32_t(known.classOf[node]);
    };
    for (uint32_t i = 0; i < case_.nodes.size(); ++i)
      if (case_.owner[i] == g) classOf(i);
    for (const Part& part : case_.parts) {
      if (part.group != g) continue;
      const CriticalPoint &a = case_.nodes[part.first], &b = case_.nodes[part.second];
      const bool isCertain = rule_.mergesByAngle(a, b, part.cellsTouch);
      if (!isCertain && !rule_.seesNeck(part.height)) continue;
      known.group.edges.push_back({classOf(part.first), classOf(part.second),
                                   isCertain ? MergeGroup::kCertain : part.height, a.position,
                                   b.position});
    }
    return known;
  }

  void shrink(Known& known) {
    for (auto& c : known.group.classes) c.isOpen = false;
    for (size_t i = 0; i < case_.nodes.size(); ++i)
      if (known.classOf[i] >= 0 && (knownBy_[i] & ~known.groups) != 0)
        known.group.classes[size_t(known.classOf[i])].isOpen = true;
    const std::vector<uint32_t> after = contract(known.group, rule_);
    const auto& edges = known.group.edges;
    hasNeedless_ = hasNeedless_ || (!edges.empty() && edges.size() >= known.group.classes.size());
    for (const MergeGroup::Edge& edge : edges)
      hasNeedless_ = hasNeedless_ || edge.height == MergeGroup::kCertain;
    for (int& c : known.classOf)
      if (c >= 0) c = int(after[size_t(c)]);
  }

  static void join(Known& known, const Known& other) {
    const auto shift = uint32_t(known.group.classes.size());
    known.groups |= other.groups;
    known.group.classes.insert(known.group.classes.end(), other.group.classes.begin(),
                               other.group.classes.end());
    for (MergeGroup::Edge edge : other.group.edges) {
      edge.first += shift;
      edge.second += shift;
      known.group.edges.push_back(edge);
    }
    for (size_t i = 0; i < known.classOf.size(); ++i) {
      if (other.classOf[i] < 0) continue;
      const uint32_t c = uint32_t(other.classOf[i]) + shift;
      if (known.classOf[i] >= 0)
        known.group.edges.push_back(
            {uint32_t(known.classOf[i]), c, MergeGroup::kCertain, Coord(0), Coord(0)});
      known.classOf[i] = int(c);
    }
  }

  const Case& case_;
  MergeRule rule_;
  std::vector<uint32_t> knownBy_;  // groups that know a node, a bit for each
  bool hasNeedless_ = false;
};

/// The groups as parts of slabs, the first the lowest.
std::vector<SlabPart> slabPartsOf(const Case& c) {
  std::vector<SlabPart> parts;
  std::vector<std::vector<char>> knows(size_t(c.groups), std::vector<char>(c.nodes.size(), 0));
  for (size_t i = 0; i < c.nodes.size(); ++i) knows[size_t(c.owner[i])][i] = 1;
  for (const Part& part : c.parts)
    for (const uint32_t node : {part.first, part.second}) knows[size_t(part.group)][node] = 1;
  for (int g = 0; g < c.groups; ++g) {
    SlabPart part;
    std::vector<uint32_t> place(c.nodes.size());
    for (size_t i = 0; i < c.nodes.size(); ++i) {
      if (!knows[size_t(g)][i]) continue;
      place[i] = uint32_t(part.graph.nodes.size());
      part.graph.nodes.push_back(c.nodes[i]);
      if (c.owner[i] != g) part.graph.nodes.back().voxels = 0;
      const auto isKnown = [&](int first, int last) {
        return std::any_of(knows.begin() + first, knows.begin() + last,
                           [&](const std::vector<char>& known) { return known[i] != 0; });
      };
      part.startsBelow.push_back(isKnown(0, g));
      part.goesOn.push_back(isKnown(g + 1, c.groups));
    }
    std::map<std::pair<uint32_t, uint32_t>, ManifoldGraph::Edge> edges;
    for (const Part& of : c.parts) {
      if (of.group != g) continue;
      const auto edge = edges
                            .emplace(std::make_pair(of.first, of.second),
                                     ManifoldGraph::Edge{place[of.first], place[of.second], 1,
                                                         of.height, of.cellsTouch})
                            .first;
      edge->second.saddleHeight = std::max(edge->second.saddleHeight, of.height);
      edge->second.cellsTouch |= of.cellsTouch;
    }
    for (const auto& [pair, edge] : edges) part.graph.edges.push_back(edge);
    parts.push_back(std::move(part));
  }
  return parts;
}

/// What is wrong with grains of these classes; empty: nothing.
std::string wrongGrains(const Case& c, const std::vector<uint32_t>& classOf,
                        const std::vector<SlabPart>& parts, const TreeGrains& grains) {
  // Those with voxels, by the node of largest D, the first of several.
  std::map<uint32_t, uint32_t> best;
  std::map<uint32_t, bool> hasVoxels;
  for (uint32_t i = 0; i < classOf.size(); ++i) {
    const auto [node, isNew] = best.emplace(classOf[i], i);
    if (!isNew && c.nodes[i].squaredRadius > c.nodes[node->second].squaredRadius) node->second = i;
    hasVoxels[classOf[i]] = hasVoxels[classOf[i]] || c.nodes[i].voxels > 0;
  }
  std::vector<Coord> expected;
  for (const auto& [name, node] : best)
    if (hasVoxels[name]) expected.push_back(c.nodes[node].position);
  std::sort(expected.begin(), expected.end());
  if (grains.representative != expected) return "other representatives";
  for (size_t p = 0; p < parts.size(); ++p)
    for (size_t i = 0; i < parts[p].graph.nodes.size(); ++i) {
      const auto node =
          size_t(std::find_if(c.nodes.begin(), c.nodes.end(),
                              [&](const CriticalPoint& point) {
                                return point.position == parts[p].graph.nodes[i].position;
                              }) -
                 c.nodes.begin());
      const uint32_t name = classOf[node], grain = grains.ofNode[p][i];
      if (grain > 0 ? expected.at(grain - 1) != c.nodes[best[name]].position : hasVoxels[name])
        return "other grain of node " + std::to_string(node);
    }
  return "";
}

std::string describe(const Case& c) {
  std::ostringstream text;
  text << "theta " << c.options.theta << " mode " << int(c.options.mode) << " adjacency "
       << int(c.options.adjacency) << " delta " << c.options.delta << " groups " << c.groups
       << "\n";
  for (const CriticalPoint& node : c.nodes)
    text << "node at " << node.position << " of D " << node.squaredRadius << "\n";
  for (const Part& part : c.parts)
    text << "edge " << part.first << " " << part.second << " h " << part.height
         << (part.cellsTouch ? " cells" : "") << " in group " << part.group << "\n";
  return text.str();
}

}  // namespace

TEST_CASE("merge_group: groups in any order give the classes of the whole", "[merge_group]") {
  const uint64_t first = fromEnvironment("VDB_MADF_SEED", 1);
  const uint64_t graphs = fromEnvironment("VDB_MADF_GRAPHS", 120000);
  uint64_t merged = 0, divided = 0;
  for (uint64_t seed = first; seed < first + graphs; ++seed) {
    const Case c = randomGraph(seed);
    Rng rng(seed + 1);
    const std::vector<uint32_t> expected = mergedByDefinition(c), found = Contractor(c).run(rng);
    if (found != expected) FAIL("seed " << seed << "\n" << describe(c));
    for (const Part& part : c.parts)
      ++(expected[part.first] == expected[part.second] ? merged : divided);
  }
  if (graphs < 1000) return;
  CHECK(merged > 3 * graphs);
  CHECK(divided > 3 * graphs);
}

TEST_CASE("merge_parts: ranges joined in any order give the grains of the whole", "[merge_group]") {
  const uint64_t first = fromEnvironment("VDB_MADF_SEED", 1) + 10000000;
  const uint64_t graphs = fromEnvironment("VDB_MADF_GRAPHS", 120000);
  uint64_t joins = 0, handedOver = 0;
  for (uint64_t seed = first; seed < first + graphs; ++seed) {
    Case c = randomGraph(seed);
    Rng rng(seed + 1);
    if (rng.chance(0.3))
      for (CriticalPoint& node : c.nodes) node.voxels = rng.below(2);
    const std::vector<SlabPart> parts = slabPartsOf(c);
    const MergeRule rule(c.options, c.weights);
    const TreeGrains found = RandomMergeTree(parts, rule, rng).run();
    const std::string wrong = wrongGrains(c, mergedByDefinition(c), parts, found);
    if (!wrong.empty()) FAIL("seed " << seed << ": " << wrong << "\n" << describe(c));
    joins += found.joins;
    handedOver += found.handedOver;
  }
  if (graphs < 1000) return;
  CHECK(joins > graphs);
  CHECK(handedOver > joins);
}

TEST_CASE("merge_group: nothing is decided that depends on other groups", "[merge_group]") {
  const MergeRule rule({MergeMode::neck, 11, -0.8, 0, Adjacency::manifold}, {});
  const Coord a(0, 0, 0), b(9, 0, 0), c(18, 0, 0);
  MergeGroup group;
  group.classes = {{100, false}, {9, true}, {100, false}};
  group.edges = {{0, 1, 9, a, b}, {1, 2, 7, b, c}};
  // At h = 9 the class of D = 9 merges with that of 100, unless it has done so elsewhere before. At
  // h = 7 it does not: 7 < 0.9 * 9.
  CHECK(contract(group, rule) == std::vector<uint32_t>{0, 1, 2});
  CHECK(group.edges.size() == 1);
  group.classes[1].isOpen = false;
  CHECK(contract(group, rule) == std::vector<uint32_t>{0, 0, 1});
  CHECK(group.edges.empty());
  CHECK(group.classes.at(0).top == 100);
}

TEST_CASE("merge_group: nothing gives nothing", "[merge_group]") {
  MergeGroup group;
  CHECK(contract(group, MergeRule({}, {})).empty());
}
