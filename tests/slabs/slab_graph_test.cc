// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

// The graph of the whole, and its grains, from the terminals of slabs: random flows of balls, which
// lead through more slabs, and more often, than those of an object do.

#include <algorithm>
#include <map>
#include <set>
#include <utility>
#include <vector>

#include "support/catch.h"
#include "support/merge_tree.h"
#include "support/random_volume.h"
#include "vdb_madf/method/merge.h"
#include "vdb_madf/slabs/cuts/slab_exits.h"
#include "vdb_madf/slabs/cuts/slab_part.h"

namespace {

using namespace vdb_madf;
using namespace vdb_madf::test;
using detail::MergeRule;
using detail::SlabExits;
using detail::SlabPart;
using detail::SlabRoot;
using detail::SlabTerminals;
using Edge = ManifoldGraph::Edge;
using FaceVoxel = SlabTerminals::FaceVoxel;

/// Balls in slabs that are 8 high, each of which flows to another one, or is critical.
struct Balls {
  std::vector<Coord> position;  // ascending
  std::vector<size_t> next;
  std::vector<int32_t> squaredRadius;
  std::vector<int> cuts;

  size_t slabOf(size_t ball) const { return size_t(position[ball].z() / 8); }
  size_t root(size_t ball) const { return next[ball] == ball ? ball : root(next[ball]); }
  /// Where a path of a slab ends that comes to a ball.
  size_t terminal(size_t slab, size_t ball) const {
    return slabOf(ball) != slab || next[ball] == ball ? ball : terminal(slab, next[ball]);
  }
};

Balls randomBalls(Rng& rng) {
  Balls balls;
  const int slabs = rng.between(1, 6), count = rng.between(1, 30), radii = rng.between(1, 20);
  for (int s = 0; s <= slabs; ++s) balls.cuts.push_back(8 * s);
  std::set<Coord> places;
  for (int i = 0; i < count; ++i) places.insert({rng.below(9), rng.below(9), rng.below(8 * slabs)});
  balls.position.assign(places.begin(), places.end());
  // Flow leads on in some order, so that it ends.
  std::vector<size_t> order(places.size());
  for (size_t i = 0; i < order.size(); ++i) {
    order[i] = i;
    std::swap(order[i], order[size_t(rng.below(int(i) + 1))]);
  }
  balls.next.resize(order.size());
  const double critical = rng.unit();
  for (size_t i = 0; i < order.size(); ++i) {
    balls.next[order[i]] = rng.chance(critical) ? order[i] : order[size_t(rng.below(int(i) + 1))];
    balls.squaredRadius.push_back(1 + rng.below(radii));
  }
  return balls;
}

/// The terminals of each slab, as balls: some, and those that these need.
std::vector<std::vector<size_t>> randomTerminals(const Balls& balls, Rng& rng) {
  std::vector<std::set<size_t>> of(balls.cuts.size() - 1);
  const double share = rng.unit() * 0.5;
  for (size_t s = 0; s < of.size(); ++s)
    for (size_t b = 0; b < balls.position.size(); ++b) {
      if (rng.chance(share)) of[s].insert(balls.terminal(s, b));
      if (balls.slabOf(b) == s && balls.next[b] == b) of[s].insert(b);
    }
  for (bool changed = true; changed;) {
    changed = false;
    for (const std::set<size_t>& terminals : of)
      for (const size_t b : std::set<size_t>(terminals)) {
        const size_t owner = balls.slabOf(b);
        changed = of[owner].insert(balls.terminal(owner, b)).second || changed;
      }
  }
  std::vector<std::vector<size_t>> result;
  for (const std::set<size_t>& terminals : of)
    result.emplace_back(terminals.begin(), terminals.end());
  return result;
}

std::vector<FaceVoxel> randomFace(size_t terminals, Rng& rng) {
  std::vector<FaceVoxel> face;
  if (terminals == 0) return face;
  const double share = rng.unit() * 0.3;
  for (int x = 0; x < 8; ++x)
    for (int y = 0; y < 8; ++y)
      if (rng.chance(share))
        face.push_back(
            {x, y,
             uint32_t(rng.between(1, int(terminals))) | (rng.chance(0.5) ? Flow::kOwnCell : 0),
             rng.between(-20, 1)});
  return face;
}

std::vector<SlabTerminals> randomSlabs(const Balls& balls,
                                       const std::vector<std::vector<size_t>>& terminals,
                                       Rng& rng) {
  std::vector<SlabTerminals> slabs;
  for (size_t s = 0; s < terminals.size(); ++s) {
    SlabTerminals slab;
    for (const size_t b : terminals[s])
      slab.points.push_back(
          {balls.position[b], balls.slabOf(b) == s ? balls.squaredRadius[b] : 0, rng.below(3)});
    const double density = rng.unit();
    for (uint32_t a = 0; a < slab.points.size(); ++a)
      for (uint32_t b = a + 1; b < slab.points.size(); ++b)
        if (rng.chance(density))
          slab.edges.push_back({a, b, rng.between(1, 9), rng.between(-1, 20), rng.chance(0.5)});
    slab.lowest = randomFace(slab.points.size(), rng);
    slab.highest = randomFace(slab.points.size(), rng);
    slabs.push_back(std::move(slab));
  }
  return slabs;
}

/// The graph of the whole, put together from critical points alone.
ManifoldGraph wholeGraph(const Balls& balls, const std::vector<std::vector<size_t>>& terminals,
                         const std::vector<SlabTerminals>& slabs) {
  ManifoldGraph graph;
  std::map<size_t, uint32_t> nodeOf;
  for (size_t b = 0; b < balls.position.size(); ++b) {
    if (balls.next[b] != b) continue;
    nodeOf[b] = uint32_t(graph.nodes.size());
    graph.nodes.push_back({balls.position[b], balls.squaredRadius[b], 0});
  }
  std::map<std::pair<uint32_t, uint32_t>, Edge> edges;
  const auto add = [&](size_t a, size_t b, int64_t faces, int32_t height, bool cells) {
    const uint32_t i = nodeOf.at(balls.root(a)), j = nodeOf.at(balls.root(b));
    if (i == j) return;
    const std::pair<uint32_t, uint32_t> pair(std::min(i, j), std::max(i, j));
    Edge& edge = edges.emplace(pair, Edge{pair.first, pair.second, 0, height, false}).first->second;
    edge.contactFaces += faces;
    edge.saddleHeight = std::max(edge.saddleHeight, height);
    edge.cellsTouch |= cells && balls.next[a] == a && balls.next[b] == b;
  };
  const auto ball = [&](size_t s, uint32_t terminal) {
    return terminals[s][(terminal & ~Flow::kOwnCell) - 1];
  };
  for (size_t s = 0; s < slabs.size(); ++s) {
    for (size_t i = 0; i < slabs[s].points.size(); ++i)
      graph.nodes[nodeOf.at(balls.root(terminals[s][i]))].voxels += slabs[s].points[i].voxels;
    for (const Edge& e : slabs[s].edges)
      add(terminals[s][e.first], terminals[s][e.second], e.contactFaces, e.saddleHeight,
          e.cellsTouch);
    if (s == 0) continue;
    for (const FaceVoxel& a : slabs[s - 1].highest)
      for (const FaceVoxel& b : slabs[s].lowest)
        if (a.x == b.x && a.y == b.y)
          add(ball(s - 1, a.terminal), ball(s, b.terminal), 1, std::min(-a.power, -b.power),
              (a.terminal & b.terminal & Flow::kOwnCell) != 0);
  }
  for (const auto& [pair, edge] : edges) graph.edges.push_back(edge);
  return graph;
}

/// Of terminals that are critical, their places in the whole from 1 on; of others 0.
std::vector<uint32_t> numbersOf(const std::vector<CriticalPoint>& points,
                                const ManifoldGraph& whole) {
  std::vector<uint32_t> numbers;
  for (const CriticalPoint& point : points) {
    const auto found =
        std::find_if(whole.nodes.begin(), whole.nodes.end(),
                     [&](const CriticalPoint& node) { return node.position == point.position; });
    numbers.push_back(found == whole.nodes.end() ? 0 : uint32_t(found - whole.nodes.begin()) + 1);
  }
  return numbers;
}

void askAndAnswer(SlabExits& exits, const Balls& balls,
                  const std::vector<std::vector<size_t>>& terminals,
                  const std::vector<SlabTerminals>& slabs) {
  for (size_t s = 0; s < terminals.size(); ++s)
    for (const SlabExits::Question& question : exits.questions(s)) {
      const auto b =
          size_t(std::lower_bound(balls.position.begin(), balls.position.end(), question.position) -
                 balls.position.begin());
      const auto found =
          std::lower_bound(terminals[s].begin(), terminals[s].end(), balls.terminal(s, b));
      const auto terminal = size_t(found - terminals[s].begin());
      exits.answer(s, question, uint32_t(terminal) + 1, slabs[s].points[terminal]);
    }
  exits.finish();
}

/// The parts of one graph, added up.
ManifoldGraph sum(const std::vector<SlabPart>& parts) {
  std::map<Coord, CriticalPoint> nodes;
  std::map<std::pair<Coord, Coord>, Edge> edges;
  for (const SlabPart& part : parts) {
    for (const CriticalPoint& node : part.graph.nodes) {
      CriticalPoint& all =
          nodes.emplace(node.position, CriticalPoint{node.position, node.squaredRadius, 0})
              .first->second;
      if (all.squaredRadius != node.squaredRadius) all.squaredRadius = -1;
      all.voxels += node.voxels;
    }
    for (const Edge& edge : part.graph.edges) {
      const std::pair<Coord, Coord> pair(part.graph.nodes[edge.first].position,
                                         part.graph.nodes[edge.second].position);
      const auto [all, isNew] = edges.emplace(pair, edge);
      if (isNew) continue;
      all->second.contactFaces += edge.contactFaces;
      all->second.saddleHeight = std::max(all->second.saddleHeight, edge.saddleHeight);
      all->second.cellsTouch |= edge.cellsTouch;
    }
  }
  ManifoldGraph graph;
  std::map<Coord, uint32_t> number;
  for (const auto& [position, node] : nodes) {
    number[position] = uint32_t(graph.nodes.size());
    graph.nodes.push_back(node);
  }
  for (const auto& [pair, edge] : edges) {
    graph.edges.push_back(edge);
    graph.edges.back().first = number[pair.first];
    graph.edges.back().second = number[pair.second];
  }
  return graph;
}

/// Has each node the number of its place in the whole?
bool areNumbered(const std::vector<SlabPart>& parts, const ManifoldGraph& whole) {
  for (const SlabPart& part : parts)
    for (size_t i = 0; i < part.number.size(); ++i)
      if (!(whole.nodes.at(part.number[i] - 1).position == part.graph.nodes[i].position))
        return false;
  return true;
}

/// Is each node said to be in a later part if it is, and in an earlier one if it is?
bool goOnWell(const std::vector<SlabPart>& parts) {
  std::set<Coord> later, earlier;
  const auto areSaid = [](const SlabPart& part, const std::vector<char>& said,
                          const std::set<Coord>& known) {
    for (size_t i = 0; i < part.graph.nodes.size(); ++i)
      if ((said.at(i) != 0) != (known.count(part.graph.nodes[i].position) > 0)) return false;
    return true;
  };
  const auto include = [](const SlabPart& part, std::set<Coord>& known) {
    for (const CriticalPoint& node : part.graph.nodes) known.insert(node.position);
  };
  for (const SlabPart& part : parts) {
    if (!areSaid(part, part.startsBelow, earlier)) return false;
    include(part, earlier);
  }
  for (size_t s = parts.size(); s-- > 0;) {
    if (!areSaid(parts[s], parts[s].goesOn, later)) return false;
    include(parts[s], later);
  }
  return true;
}

/// The part of each slab.
std::vector<SlabPart> partsOf(const SlabExits& exits, const std::vector<SlabTerminals>& slabs,
                              const std::vector<std::vector<uint32_t>>& numbers) {
  std::vector<std::vector<Edge>> contacts(slabs.size());
  std::vector<std::vector<uint32_t>> touched(slabs.size() + 1);  // terminals of the slab below
  for (size_t s = 1; s < slabs.size(); ++s) {
    contacts[s] = SlabTerminals::contacts(slabs[s - 1].highest, slabs[s].lowest);
    std::set<uint32_t> all;
    for (const Edge& edge : contacts[s]) all.insert(edge.first);
    touched[s].assign(all.begin(), all.end());
    for (Edge& edge : contacts[s])
      edge.first = uint32_t(std::distance(all.begin(), all.find(edge.first)));
  }
  std::vector<SlabPart> parts;
  std::vector<SlabRoot> roots, below;
  for (size_t s = 0; s < slabs.size(); ++s) {
    below.clear();
    for (const uint32_t terminal : touched[s]) below.push_back(roots.at(terminal));
    roots = slabRoots(s, slabs[s].points, numbers[s], exits.leads(s));
    parts.push_back(slabPart(s, slabs[s], roots, contacts[s], below, touched[s + 1]));
  }
  return parts;
}

}  // namespace

TEST_CASE("slab_graph: parts are those of the whole, and so are the grains", "[slab_graph]") {
  uint64_t grains = 0, nodes = 0;
  for (uint64_t seed = 1; seed <= 6000; ++seed) {
    INFO("seed " << seed);
    Rng rng(seed);
    const Balls balls = randomBalls(rng);
    const auto terminals = randomTerminals(balls, rng);
    const auto slabs = randomSlabs(balls, terminals, rng);
    ManifoldGraph whole = wholeGraph(balls, terminals, slabs);

    SlabExits exits(balls.cuts);
    for (size_t s = 0; s < slabs.size(); ++s) {
      std::vector<SlabExits::Exit> of;
      for (uint32_t i = 0; i < terminals[s].size(); ++i)
        if (balls.slabOf(terminals[s][i]) != s) of.push_back({i, slabs[s].points[i].position});
      exits.add(terminals[s].size(), of);
    }
    REQUIRE(exits.criticalPoints() == int64_t(whole.nodes.size()));
    askAndAnswer(exits, balls, terminals, slabs);
    std::vector<std::vector<uint32_t>> numbers;
    for (size_t s = 0; s < slabs.size(); ++s) {
      numbers.push_back(numbersOf(slabs[s].points, whole));
      exits.tellNumbers(s, numbers[s]);
    }
    const std::vector<SlabPart> parts = partsOf(exits, slabs, numbers);
    const ManifoldGraph added = sum(parts);
    REQUIRE(added.nodes == whole.nodes);
    REQUIRE(added.edges == whole.edges);
    REQUIRE(goOnWell(parts));
    REQUIRE(areNumbered(parts, whole));
    const ManifoldGraph joined = joinedGraph({parts.begin(), parts.end()});
    REQUIRE(joined.nodes == whole.nodes);
    REQUIRE(joined.edges == whole.edges);

    const double thetas[] = {-1, -0.9, -0.8, -0.5, 0, 0.5};
    const MergeOptions options{MergeMode(rng.below(3)), 11, thetas[rng.below(6)],
                               rng.chance(0.5) ? 0 : rng.below(9), Adjacency(rng.below(2))};
    if (rng.chance(0.3)) whole.weights = {rng.between(1, 9), rng.between(1, 9), 1};
    const Merging expected = merge(whole, options);
    const MergeRule rule(options, whole.weights);
    const TreeGrains found = RandomMergeTree(parts, rule, rng).run();
    REQUIRE(found.representative.size() == expected.representative.size());
    for (size_t g = 0; g < expected.representative.size(); ++g)
      REQUIRE(found.representative[g] == whole.nodes[expected.representative[g]].position);
    std::map<Coord, int32_t> grainAt;
    for (size_t i = 0; i < whole.nodes.size(); ++i)
      grainAt[whole.nodes[i].position] = expected.grainOfNode[i];
    for (size_t s = 0; s < parts.size(); ++s)
      for (size_t i = 0; i < terminals[s].size(); ++i) {
        const Coord root = balls.position[balls.root(terminals[s][i])];
        REQUIRE(int32_t(found.ofNode[s][parts[s].nodeOf[i]]) == grainAt.at(root));
      }
    grains += expected.representative.size();
    nodes += whole.nodes.size();
  }
  CHECK(grains < nodes * 3 / 4);
  CHECK(grains > nodes / 4);
}
