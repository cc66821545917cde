// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/method/manifold_graph.h"
#include "vdb_madf/leaves/leaf_grid.h"

#include <algorithm>
#include <cctype>
#include <map>
#include <string>
#include <vector>

#include "support/catch.h"
#include "support/edge_cases.h"
#include "support/invariants.h"
#include "support/random_volume.h"
#include "support/runs.h"
#include "support/stage_input.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/method/flow.h"

namespace {

using namespace vdb_madf;
using namespace vdb_madf::test;
using Edge = ManifoldGraph::Edge;
using Edges = std::vector<Edge>;

std::string edgeText(const Edge& edge) {
  return std::to_string(edge.first) + "-" + std::to_string(edge.second) + " faces " +
         std::to_string(edge.contactFaces) + " h " + std::to_string(edge.saddleHeight) +
         (edge.cellsTouch ? " cells" : "");
}

/// Empty if they are equal, else the first difference.
std::string edgeDifference(const Edges& found, const Edges& expected) {
  for (size_t i = 0; i < found.size() && i < expected.size(); ++i)
    if (!(found[i] == expected[i]))
      return edgeText(found[i]) + ", expected " + edgeText(expected[i]);
  return found.size() == expected.size() ? "" : std::to_string(found.size()) + " edges";
}

/// Where each voxel flows to, whether it goes there in one step, and its power.
struct Manifolds {
  ObjectVolume object;
  SiteMap critical;
  OraclePower map;
  DenseVolume<int64_t> distance;

  explicit Manifolds(const CoordBBox& box)
      : object(box),
        critical(box, kNoSite),
        map{SiteMap(box, kNoSite), DenseVolume<int64_t>(box)},
        distance(box) {}

  ManifoldGraph expected() const { return oracleGraph(object, distance, map, critical); }

  Flow flow(const LeafIndex& index) const {
    Flow result;
    result.criticalPoints = expected().nodes;
    std::map<Coord, uint32_t> number;
    for (const auto& node : result.criticalPoints) {
      const auto next = uint32_t(number.size() + 1);
      number[node.position] = next;
    }
    result.manifold = byRank<uint32_t>(index, [&](const Coord& p) {
      const bool own = map.site[p] == critical[p];
      return number.at(critical.coord(critical[p])) | (own ? Flow::kOwnCell : 0);
    });
    return result;
  }

  ManifoldGraph graph(Tiles tiles = Tiles::none) const {
    const LeafIndex index(*toMask(object, tiles));
    return manifoldGraph(index, flow(index), byRank<int32_t>(index, map.power));
  }
};

/// Letters are manifolds, named after their first voxel; capitals: in the cell of its critical
/// point. `powers`: along the rows, for as long as they last.
Manifolds drawn(const std::string& letters, const std::vector<int>& powers = {},
                const Coord& origin = Coord(0)) {
  std::string shape = letters;
  for (char& c : shape)
    if (std::isalpha(c)) c = '#';
  const ObjectVolume object = fromPicture(shape, origin);
  Manifolds m(object.box());
  m.object = object;
  std::map<char, int> first;
  int i = 0;
  for (const char c : letters) {
    if (c == '/' || c == '|') continue;
    if (object[i]) {
      m.critical[i] = first.insert({char(std::toupper(c)), i}).first->second;
      m.map.site[i] = std::isupper(c) ? m.critical[i] : (m.critical[i] == 0 ? 1 : 0);
    }
    m.map.power[i] = i < int(powers.size()) ? powers[size_t(i)] : -1;
    ++i;
  }
  return m;
}

/// Any voxels in any manifolds, powers of either sign.
Manifolds anyManifolds(const CoordBBox& box, VolumeKind kind, uint64_t seed, int manifolds) {
  Rng rng(seed);
  Manifolds m(box);
  m.object = randomVolume(kind, box, rng);
  std::vector<int> voxels;
  for (int i = 0; i < m.object.size(); ++i)
    if (m.object[i]) voxels.push_back(i);
  const double changes = rng.unit();
  int last = -1;
  for (const int i : voxels) {
    if (last < 0 || rng.chance(changes))
      last = voxels[size_t(rng.below(manifolds)) * 7919 % voxels.size()];
    m.critical[i] = last;
    m.map.site[i] = rng.chance(0.3) ? last : -2;
    m.map.power[i] = rng.between(-300, 100);
    m.distance[i] = 1 + rng.below(500);
  }
  return m;
}

/// The oracle's.
Manifolds oracleManifolds(const ObjectVolume& object, int64_t gamma) {
  Manifolds m(object.box());
  m.object = object;
  m.distance = oracleDistance(object, false, {});
  m.map = oraclePower(object, m.distance, object);
  if (gamma > 0)
    m.map = oracleFilteredPower(
        object, m.distance, oracleKeptBalls(object, m.map, oracleBalls(m.map, m.distance), gamma));
  m.critical = oracleFlow(m.map.site);
  return m;
}

void requireOracleGraph(const Manifolds& m, Tiles tiles = Tiles::none) {
  const ManifoldGraph found = m.graph(tiles), expected = m.expected();
  REQUIRE((found.nodes == expected.nodes));
  REQUIRE(edgeDifference(found.edges, expected.edges) == "");
}

}  // namespace

TEST_CASE("manifold_graph: drawn by hand", "[manifold_graph]") {
  CHECK(drawn("aaa").graph().edges.empty());
  CHECK(drawn("a.b").graph().edges.empty());
  CHECK(drawn("a./.b").graph().edges.empty());        // along an edge
  CHECK(drawn("a./..|../.b").graph().edges.empty());  // at a corner
  CHECK(edgeDifference(drawn("ab").graph().edges, {{0, 1, 1, 1, false}}) == "");
  // Three pairs, of the heights min(5, 3), min(4, 9), min(-2, 7).
  CHECK(edgeDifference(drawn("ab/ab/ab", {-5, -3, -4, -9, 2, -7}).graph().edges,
                       {{0, 1, 3, 4, false}}) == "");
  CHECK(edgeDifference(drawn("ab", {2, 7}).graph().edges, {{0, 1, 1, -7, false}}) == "");
  // Cells touch where both voxels of a pair are in them: not across two pairs.
  CHECK(edgeDifference(drawn("AB").graph().edges, {{0, 1, 1, 1, true}}) == "");
  CHECK(edgeDifference(drawn("Ab/aB").graph().edges, {{0, 1, 2, 1, false}}) == "");
  CHECK(edgeDifference(drawn("ab/AB").graph().edges, {{0, 1, 2, 1, true}}) == "");
  // Sorted by both, each pair once, whichever comes first.
  CHECK(edgeDifference(drawn("abc/cab").graph().edges,
                       {{0, 1, 3, 1, false}, {0, 2, 2, 1, false}, {1, 2, 2, 1, false}}) == "");
}

TEST_CASE("manifold_graph: pairs across the borders of leaves", "[manifold_graph]") {
  for (int axis = 0; axis < 3; ++axis)
    for (const int border : {-8, 0, 8, 128}) {
      Coord lower(3), dim(1);
      lower[axis] = border - 1;
      dim[axis] = 2;
      Manifolds m(boxAt(lower, dim));
      for (int i = 0; i < 2; ++i) {
        m.object[i] = 1;
        m.critical[i] = m.map.site[i] = i;
        m.map.power[i] = -4 - i;
      }
      CAPTURE(axis, border);
      CHECK(edgeDifference(m.graph().edges, {{0, 1, 1, 4, true}}) == "");
      requireOracleGraph(m);
    }
}

TEST_CASE("manifold_graph: of edge cases", "[manifold_graph]") {
  for (const EdgeCase& c : edgeCases())
    for (const int64_t gamma : {0, 30}) {
      INFO(c.name << ", gamma " << gamma);
      requireOracleGraph(oracleManifolds(c.object, gamma), c.tiles);
    }
}

TEST_CASE("manifold_graph: of the oracle's flows", "[manifold_graph]") {
  for (uint64_t seed = 1; seed <= 190; ++seed) {
    Rng rng(seed);
    const auto kind = VolumeKind(int(seed) % kVolumeKinds);
    const Coord size(rng.between(1, 12), rng.between(1, 12), rng.between(1, 12));
    const ObjectVolume object = randomVolume(kind, boxAt(randomOrigin(rng), size), rng);
    const int64_t gamma = rng.chance(0.5) ? 0 : rng.between(2, 30);
    INFO("seed " << seed << ", " << name(kind) << ", gamma " << gamma << '\n' << picture(object));
    const Manifolds m = oracleManifolds(object, gamma);
    requireOracleGraph(m, seed % 2 ? Tiles::wherePossible : Tiles::none);
    // What holds for every graph of a segmentation, by another count.
    const ManifoldGraph graph = m.graph();
    std::map<Coord, int64_t> number;
    for (const auto& node : graph.nodes) number.insert({node.position, int64_t(number.size()) + 1});
    DenseVolume<int64_t> manifold(object.box());
    for (int i = 0; i < object.size(); ++i)
      if (object[i]) manifold[i] = number.at(object.coord(m.critical[i]));
    const auto grid = test::toGrid(object, manifold), power = test::toGrid(object, m.map.power);
    REQUIRE(nodesMatchManifolds(graph, *grid, *power) == "");
    REQUIRE(edgesMatchManifolds(graph, *grid, *power) == "");
  }
}

TEST_CASE("manifold_graph: of any manifolds", "[manifold_graph]") {
  size_t mostEdges = 0;
  for (uint64_t seed = 1; seed <= 150; ++seed) {
    Rng rng(~seed);
    const auto kind = VolumeKind(int(seed) % kVolumeKinds);
    const Coord size(rng.between(1, 20), rng.between(1, 20), rng.between(1, 20));
    const int manifolds = 1 << rng.between(0, 11);
    CAPTURE(seed, name(kind), manifolds);
    const Manifolds m = anyManifolds(boxAt(randomOrigin(rng), size), kind, seed, manifolds);
    requireOracleGraph(m);
    mostEdges = std::max(mostEdges, m.expected().edges.size());
  }
  CHECK(mostEdges > 1000);
}

TEST_CASE("manifold_graph: threads do not matter", "[manifold_graph]") {
  // More leaves than one task takes, and the same pairs in many of them.
  for (const int manifolds : {5, 3000}) {
    const Manifolds m =
        anyManifolds(boxAt({-1, -150, 3}, {2, 300, 310}), VolumeKind::denseNoise, 6, manifolds);
    const LeafIndex index(*toMask(m.object));
    REQUIRE(index.leafCount() > 2048);
    const Flow flow = m.flow(index);
    const auto power = byRank<int32_t>(index, m.map.power);
    const ManifoldGraph expected = m.expected();
    for (const int threads : {1, 2, 4, 4}) {
      CAPTURE(manifolds, threads);
      const ManifoldGraph found =
          withThreads(threads, [&] { return manifoldGraph(index, flow, power); });
      CHECK((found.nodes == expected.nodes));
      CHECK(edgeDifference(found.edges, expected.edges) == "");
    }
  }
}

TEST_CASE("manifold_graph: of a ball that reaches out of an open domain D is not sure",
          "[manifold_graph]") {
  ManifoldGraph graph;
  graph.nodes = {{{4, 5, 5}, 25, 1}, {{4, 5, 5}, 26, 1}, {{5, 5, 6}, 16, 1}, {{5, 5, 6}, 17, 1}};
  const auto doubts = [&](const Domain& domain, bool open = true) {
    placeGraph(graph, domain, open);
    std::vector<int32_t> found;
    for (const CriticalPoint& node : graph.nodes) found.push_back(node.doubt);
    return found;
  };
  const CoordBBox box({0, 0, 0}, {19, 19, 9});  // the voxels next to its faces are 5 and 4 away
  CHECK(doubts(box) == std::vector<int32_t>{0, 26, 0, 17});
  CHECK(doubts(box, false) == std::vector<int32_t>{0, 0, 0, 0});
  CHECK(graph.flatAxis == std::nullopt);
  graph.weights = {1, 1, 4};
  CHECK(doubts(box) == std::vector<int32_t>{0, 26, 0, 0});
  graph.nodes[0].position.z() = graph.nodes[1].position.z() = 6;
  CHECK(doubts(CoordBBox({0, 0, 6}, {19, 19, 6})) == std::vector<int32_t>{0, 26, 0, 0});
  CHECK(graph.flatAxis == 2);
  MaskTree slice;  // with a hole in it
  slice.fill(CoordBBox({0, 0, 6}, {19, 19, 6}), true);
  slice.setValueOff({5, 9, 6});
  CHECK(doubts(Domain(slice)) == std::vector<int32_t>{25, 26, 0, 17});
}

TEST_CASE("manifold_graph: balls reach out of regions as the voxels say",
          "[manifold_graph][long]") {
  int out = 0, within = 0;
  for (uint64_t seed = 1; seed <= 200; ++seed) {
    Rng rng(seed);
    // Tiles of all sizes, and voxels that are missing here and there.
    MaskTree region;
    const Coord corner = randomOrigin(rng) & ~127;
    region.fill(boxAt(corner, {256, 128, 136}), true);
    if (rng.chance(0.3)) region.fill(CoordBBox::createCube(corner & ~4095, 4096), true);
    for (int hole = rng.below(40); hole > 0; --hole)
      region.setValueOff(corner + Coord(rng.below(256), rng.below(128), rng.below(136)));
    if (rng.chance(0.3)) region.fill(boxAt(corner + Coord(128, 0, 0), {128, 128, 128}), false);
    region.prune();
    const Domain domain(region);
    ManifoldGraph graph;
    if (rng.chance(0.5)) graph.weights = {rng.between(1, 9), rng.between(1, 9), rng.between(1, 9)};
    for (int i = 0; i < 20; ++i)
      graph.nodes.push_back({corner + Coord(rng.below(256), rng.below(128), rng.below(136)),
                             1 + rng.below(rng.chance(0.5) ? 40 : 900), 1});
    placeGraph(graph, domain, true);
    for (const CriticalPoint& node : graph.nodes) {
      bool isSure = true;
      const int reach = 30;  // the square of which no D is above
      for (auto d = CoordBBox(Coord(-reach), Coord(reach)).begin(); d && isSure; ++d)
        isSure = squaredLength(*d, graph.weights) >= node.squaredRadius ||
                 domain.isInside(node.position + *d);
      CAPTURE(seed, node.position, node.squaredRadius, graph.weights.toString());
      REQUIRE(node.doubt == (isSure ? 0 : node.squaredRadius));
      ++(isSure ? within : out);
    }
  }
  CHECK(out > 500);
  CHECK(within > 500);
}

TEST_CASE("manifold_graph: none once interrupted", "[manifold_graph]") {
  const Manifolds m = drawn("ab");
  const LeafIndex index(*toMask(m.object));
  StopAtOnce stop;
  CHECK_THROWS_AS(manifoldGraph(index, m.flow(index), byRank<int32_t>(index, m.map.power), &stop),
                  Interrupted);
}
