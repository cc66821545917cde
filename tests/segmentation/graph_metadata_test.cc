// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/segmentation/graph_metadata.h"
#include "vdb_madf/segmentation/initialize.h"

#include <openvdb/Metadata.h>

#include <cstring>
#include <limits>
#include <random>
#include <sstream>
#include <string>

#include "support/catch.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/base/limits.h"

using namespace vdb_madf;

namespace {

constexpr char kName[] = "madf_manifold_graph";

ManifoldGraph emptyGraph() {
  return {};
}

/// Values at the ends of their ranges.
ManifoldGraph extremeGraph() {
  constexpr int32_t kLow = std::numeric_limits<int32_t>::min(),
                    kHigh = std::numeric_limits<int32_t>::max();
  constexpr int64_t kMany = std::numeric_limits<int64_t>::max();
  constexpr int64_t kMaxVoxels = int64_t(kMaxLeaves) * 512;
  constexpr int kFar = kMaxCoordinate;
  ManifoldGraph graph;
  graph.nodes = {{Coord(-kFar, kFar, -1), kHigh, kMaxVoxels},
                 {Coord(-1, -kFar, 5), 1, 1},
                 {Coord(-1, -kFar, 6), 0x01020304, 0x04050607},
                 {Coord(kFar, kFar, kFar), 2, 2}};
  graph.edges = {{0, 1, kMany, kLow, true}, {0, 3, 1, kHigh, false}, {2, 3, 7, -1, true}};
  return graph;
}

ManifoldGraph randomGraph(uint32_t seed, int nodes) {
  std::mt19937 random(seed);
  ManifoldGraph graph;
  int x = -50000;
  for (int i = 0; i < nodes; ++i) {
    x += 1 + int(random() % 9);
    graph.nodes.push_back({Coord(x, int(random() % 99) - 50, int(random() % 99)),
                           int(random() % 9999), int64_t(random())});
  }
  for (uint32_t i = 0; i + 1 < uint32_t(nodes); ++i) {
    for (uint32_t j = i + 1; j < uint32_t(nodes) && j < i + 5; ++j)
      if (random() % 2)
        graph.edges.push_back({i, j, int64_t(random()), int(random()), random() % 2 == 0});
  }
  return graph;
}

bool equal(const ManifoldGraph& a, const ManifoldGraph& b) {
  return a.nodes == b.nodes && a.edges == b.edges;
}

/// As in a file: size (u32), value.
std::string stored(const ManifoldGraph& graph) {
  const auto grid = Int32Grid::create();
  setGraph(*grid, graph);
  std::ostringstream stream;
  (*grid)[kName]->write(stream);
  return stream.str();
}

/// Read from such bytes; `exceptions`: of the stream.
ManifoldGraph restored(const std::string& bytes, bool exceptions) {
  std::istringstream stream(bytes);
  if (exceptions) stream.exceptions(std::ios::badbit | std::ios::failbit | std::ios::eofbit);
  const auto metadata = openvdb::Metadata::createMetadata(kName);
  metadata->read(stream);
  const auto grid = Int32Grid::create();
  grid->insertMeta(kName, *metadata);
  return storedGraph(*grid).value();
}

GraphPart randomPart(uint32_t seed, int nodes) {
  std::mt19937 random(seed + 77);
  GraphPart part{randomGraph(seed, nodes), {}, {}};
  uint32_t number = 0;
  for (int i = 0; i < nodes; ++i) {
    number += 1 + random() % 5;
    part.number.push_back(number);
    part.goesOn.push_back(char(random() % 2));
  }
  return part;
}

bool equal(const GraphPart& a, const GraphPart& b) {
  return equal(a.graph, b.graph) && a.number == b.number && a.goesOn == b.goesOn;
}

/// As stored() and restored().
std::string stored(const GraphPart& part) {
  const auto grid = Int32Grid::create();
  setGraphPart(*grid, part);
  std::ostringstream stream;
  (*grid)[kName]->write(stream);
  return stream.str();
}
GraphPart restoredPart(const std::string& bytes) {
  std::istringstream stream(bytes);
  const auto metadata = openvdb::Metadata::createMetadata(kName);
  metadata->read(stream);
  const auto grid = Int32Grid::create();
  grid->insertMeta(kName, *metadata);
  return storedGraphPart(*grid).value();
}

std::string withSize(std::string bytes) {
  const uint32_t size = uint32_t(bytes.size() - 4);
  std::memcpy(bytes.data(), &size, 4);
  return bytes;
}

}  // namespace

TEST_CASE("graph_metadata: a grid gives back its graph", "[graph_metadata]") {
  initialize();
  for (const ManifoldGraph& original :
       {emptyGraph(), extremeGraph(), randomGraph(1, 2), randomGraph(2, 10000)}) {
    const auto grid = Int32Grid::create();
    REQUIRE_FALSE(storedGraph(*grid));
    setGraph(*grid, original);
    REQUIRE(equal(storedGraph(*grid).value(), original));
    // A copy of the grid keeps it, and is not touched by what happens to the first.
    const auto copy = grid->deepCopy();
    setGraph(*grid, emptyGraph());
    REQUIRE(equal(storedGraph(*grid).value(), emptyGraph()));
    REQUIRE(equal(storedGraph(*copy).value(), original));
  }
}

TEST_CASE("graph_metadata: bytes give back the graph", "[graph_metadata]") {
  initialize();
  for (const ManifoldGraph& original : {emptyGraph(), extremeGraph(), randomGraph(3, 7000)}) {
    REQUIRE(equal(restored(stored(original), false), original));
    REQUIRE(equal(restored(stored(original), true), original));
  }
}

TEST_CASE("graph_metadata: layout is little-endian and of the stated size", "[graph_metadata]") {
  initialize();
  ManifoldGraph graph;
  graph.nodes = {{Coord(1, -2, 3), 4, 5}, {Coord(0x01020304, 0, 0), 6, 7}};
  graph.edges = {{0, 1, 0x0102030405060708, -1, true}};
  const std::string expected(
      "\x51\0\0\0"                         // 12 + 2 * 24 + 21 bytes
      "\1\0\0\0\2\0\0\0\1\0\0\0"           // version, nodes, edges
      "\1\0\0\0\xfe\xff\xff\xff\3\0\0\0"   // position
      "\4\0\0\0\5\0\0\0\0\0\0\0"           // squared radius, voxels
      "\4\3\2\1\0\0\0\0\0\0\0\0"           // position
      "\6\0\0\0\7\0\0\0\0\0\0\0"           // squared radius, voxels
      "\0\0\0\0\1\0\0\0\x8\7\6\5\4\3\2\1"  // first, second, contact faces
      "\xff\xff\xff\xff\1",                // saddle height, cells touch
      85);
  REQUIRE(stored(graph) == expected);
}

TEST_CASE("graph_metadata: says briefly what it is", "[graph_metadata]") {
  initialize();
  const auto grid = Int32Grid::create();
  setGraph(*grid, extremeGraph());
  REQUIRE((*grid)[kName]->str() == "4 critical points, 3 edges");
  REQUIRE((*grid)[kName]->asBool());
  REQUIRE((*grid)[kName]->typeName() == kName);
  setGraph(*grid, emptyGraph());
  REQUIRE_FALSE((*grid)[kName]->asBool());
}

TEST_CASE("graph_metadata: replaces other metadata of its name", "[graph_metadata]") {
  initialize();
  const auto grid = Int32Grid::create();
  grid->insertMeta(kName, openvdb::Int32Metadata(5));
  REQUIRE_FALSE(storedGraph(*grid));
  setGraph(*grid, extremeGraph());
  REQUIRE(equal(storedGraph(*grid).value(), extremeGraph()));
}

TEST_CASE("graph_metadata: a graph that breaks the rules is refused", "[graph_metadata]") {
  initialize();
  const auto refused = [](auto change) {
    ManifoldGraph graph = extremeGraph();
    change(graph);
    const auto grid = Int32Grid::create();
    REQUIRE_THROWS_AS(setGraph(*grid, graph), InvalidInput);
    REQUIRE(grid->metaCount() == 0);
  };
  refused([](ManifoldGraph& g) { std::swap(g.nodes[1], g.nodes[2]); });
  refused([](ManifoldGraph& g) { g.nodes[1] = g.nodes[2]; });
  refused([](ManifoldGraph& g) { g.nodes[1].voxels = -1; });
  refused([](ManifoldGraph& g) { g.nodes[1].squaredRadius = -1; });
  refused([](ManifoldGraph& g) { ++g.nodes[0].voxels; });
  refused([](ManifoldGraph& g) { ++g.nodes[3].position.z(); });
  refused([](ManifoldGraph& g) { --g.nodes[0].position.x(); });
  refused([](ManifoldGraph& g) { std::swap(g.edges[0], g.edges[1]); });
  refused([](ManifoldGraph& g) { g.edges[1] = g.edges[0]; });
  refused([](ManifoldGraph& g) { g.edges[2].second = 4; });
  refused([](ManifoldGraph& g) { g.edges[2].first = 3; });
  refused([](ManifoldGraph& g) { g.edges[2].contactFaces = -1; });
}

TEST_CASE("graph_metadata: bytes that end early are refused", "[graph_metadata]") {
  initialize();
  const std::string bytes = stored(extremeGraph());
  for (size_t length = 4; length < bytes.size(); ++length) {
    for (const bool exceptions : {false, true}) {
      REQUIRE_THROWS_AS(restored(bytes.substr(0, length), exceptions), std::exception);
      REQUIRE_THROWS_AS(restored(withSize(bytes.substr(0, length)), exceptions), std::exception);
    }
  }
}

TEST_CASE("graph_metadata: huge counts are refused before memory is taken", "[graph_metadata]") {
  initialize();
  const std::string bytes = stored(extremeGraph());
  for (const size_t count : {size_t(8), size_t(12)}) {  // of nodes, of edges
    std::string changed = bytes;
    std::memset(&changed[count], 0xff, 4);
    REQUIRE_THROWS_AS(restored(changed, false), std::exception);
  }
  // Counts that agree with the size, over a file that is not there.
  std::string changed = bytes.substr(0, 16);
  const uint32_t nodes = 0x7fffff0 / 24, size = 12 + 24 * nodes;
  std::memcpy(&changed[0], &size, 4);
  std::memcpy(&changed[8], &nodes, 4);
  std::memset(&changed[12], 0, 4);
  REQUIRE_THROWS_AS(restored(changed, false), std::exception);
  // A size that only a 64-bit product shows to be wrong.
  changed = bytes.substr(0, 16);
  const uint32_t many = 0x80000000u, wrapped = 12 + uint32_t(24u * many);
  std::memcpy(&changed[0], &wrapped, 4);
  std::memcpy(&changed[8], &many, 4);
  std::memset(&changed[12], 0, 4);
  REQUIRE_THROWS_AS(restored(changed, false), std::exception);
}

TEST_CASE("graph_metadata: damaged bytes are read or refused", "[graph_metadata]") {
  initialize();
  const uint32_t seed = GENERATE(1u, 2u, 3u);
  INFO("seed " << seed);
  std::mt19937 random(seed);
  const std::string bytes = stored(randomGraph(seed, 20));
  int refused = 0;
  for (int round = 0; round < 3000; ++round) {
    std::string changed = bytes;
    for (uint32_t i = 0, n = 1 + random() % 3; i < n; ++i) {
      char& byte = changed[random() % changed.size()];
      byte = random() % 2 ? char(byte ^ (1 << random() % 8)) : char(random());
    }
    try {
      const ManifoldGraph graph = restored(changed, random() % 2 == 0);
      for (const auto& edge : graph.edges) REQUIRE(edge.second < graph.nodes.size());
    } catch (const std::exception&) {
      ++refused;
    }
  }
  REQUIRE(refused > 300);
}

TEST_CASE("graph_metadata: a grid gives back its part of a graph, and no graph",
          "[graph_metadata]") {
  initialize();
  for (const GraphPart& original : {randomPart(1, 0), randomPart(2, 3), randomPart(3, 7000)}) {
    const auto grid = Int32Grid::create();
    setGraph(*grid, extremeGraph());
    REQUIRE_FALSE(storedGraphPart(*grid));
    setGraphPart(*grid, original);
    REQUIRE(equal(storedGraphPart(*grid).value(), original));
    REQUIRE(equal(restoredPart(stored(original)), original));
    REQUIRE(equal(storedGraphPart(*grid->deepCopy()).value(), original));
    REQUIRE_THROWS_AS(storedGraph(*grid), InvalidInput);
    REQUIRE_THROWS_AS(requiredGraph(*grid), InvalidInput);
    removeGraph(*grid);
    REQUIRE_FALSE(storedGraphPart(*grid));
    REQUIRE_FALSE(storedGraph(*grid));
  }
}

TEST_CASE("graph_metadata: the numbers of a part follow its edges", "[graph_metadata]") {
  initialize();
  GraphPart part;
  part.graph.nodes = {{Coord(1, -2, 3), 4, 5}};
  part.number = {0x01020304};
  part.goesOn = {1};
  const std::string expected(
      "\x29\0\0\0"                        // 12 + 24 + 5 bytes
      "\2\0\0\0\1\0\0\0\0\0\0\0"          // version, nodes, edges
      "\1\0\0\0\xfe\xff\xff\xff\3\0\0\0"  // position
      "\4\0\0\0\5\0\0\0\0\0\0\0"          // squared radius, voxels
      "\4\3\2\1\1",                       // number, goes on
      45);
  REQUIRE(stored(part) == expected);
}

TEST_CASE("graph_metadata: voxels in cavities follow all else", "[graph_metadata]") {
  initialize();
  GraphPart part;
  part.graph.nodes = {{Coord(1, -2, 3), 4, 5, 0x0203}};
  part.number = {0x01020304};
  part.goesOn = {1};
  const std::string asPart = stored(part), whole = stored(part.graph);
  REQUIRE(asPart.substr(0, 8) == std::string("\x31\0\0\0\4\0\0\0", 8));
  REQUIRE(asPart.substr(asPart.size() - 9) == std::string("\1\3\2\0\0\0\0\0\0", 9));
  REQUIRE(whole.substr(0, 8) == std::string("\x2c\0\0\0\3\0\0\0", 8));
  REQUIRE(equal(restoredPart(asPart), part));
  REQUIRE(equal(restored(whole, true), part.graph));
  for (size_t length = 4; length < whole.size(); ++length)
    REQUIRE_THROWS_AS(restored(withSize(whole.substr(0, length)), true), std::exception);
  part.graph.nodes[0].cavityVoxels = -1;
  REQUIRE_THROWS_AS(setGraphPart(*Int32Grid::create(), part), InvalidInput);
}

TEST_CASE("graph_metadata: a part that breaks the rules, or is damaged, is refused",
          "[graph_metadata]") {
  initialize();
  const auto refused = [](auto change) {
    GraphPart part = randomPart(4, 5);
    change(part);
    const auto grid = Int32Grid::create();
    REQUIRE_THROWS_AS(setGraphPart(*grid, part), InvalidInput);
    REQUIRE(grid->metaCount() == 0);
  };
  refused([](GraphPart& p) { p.number[0] = 0; });
  refused([](GraphPart& p) { p.number[2] = p.number[1]; });
  refused([](GraphPart& p) { std::swap(p.number[2], p.number[1]); });
  refused([](GraphPart& p) { p.number[4] = 0x80000000u; });
  refused([](GraphPart& p) { p.number.pop_back(); });
  refused([](GraphPart& p) { p.goesOn.pop_back(); });
  refused([](GraphPart& p) { std::swap(p.graph.nodes[1], p.graph.nodes[2]); });

  const std::string bytes = stored(randomPart(5, 4));
  for (size_t length = 4; length < bytes.size(); ++length)
    REQUIRE_THROWS_AS(restoredPart(withSize(bytes.substr(0, length))), std::exception);
  std::string changed = bytes;
  changed.back() = 2;  // neither true nor false
  REQUIRE_THROWS_AS(restoredPart(changed), std::exception);
  changed = bytes;
  changed[4] = 5;  // version
  REQUIRE_THROWS_AS(restoredPart(changed), std::exception);
}

TEST_CASE("graph_metadata: parts that are not of one graph are not joined", "[graph_metadata]") {
  // Two manifolds that touch, one of them in both parts.
  const std::vector<GraphPart> parts{
      {{{{Coord(0, 0, 7), 9, 40}}, {}, {}, 1}, {1}, {1}},
      {{{{Coord(0, 0, 7), 9, 2}, {Coord(5, 0, 9), 4, 3}}, {{0, 1, 7, 3, false}}, {}, 1},
       {1, 2},
       {0, 0}}};
  const ManifoldGraph joined = joinedGraph(parts);
  REQUIRE(joined.nodes ==
          std::vector<CriticalPoint>{{Coord(0, 0, 7), 9, 42}, {Coord(5, 0, 9), 4, 3}});
  REQUIRE(joined.edges == parts[1].graph.edges);
  REQUIRE(joined.flatAxis == 1);
  REQUIRE(joinedGraph({}).nodes.empty());
  const auto refused = [&](auto change) {
    std::vector<GraphPart> changed = parts;
    change(changed);
    REQUIRE_THROWS_AS(joinedGraph(changed), InvalidInput);
  };
  refused([](auto& p) { ++p[1].graph.nodes[0].squaredRadius; });
  refused([](auto& p) { ++p[0].graph.nodes[0].position.z(); });
  refused([](auto& p) { p[1].number[1] = 3; });
  refused([](auto& p) { p[1].number[1] = 0x7fffffff; });
  refused([](auto& p) {
    p[0].number[0] = 2;
    p[0].graph.nodes[0] = p[1].graph.nodes[1];
    p[1] = p[0];
  });
}
