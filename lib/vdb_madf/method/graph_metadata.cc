// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/method/graph_metadata.h"

#include <openvdb/Metadata.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <istream>
#include <limits>
#include <memory>
#include <ostream>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "vdb_madf/base/errors.h"
#include "vdb_madf/base/limits.h"
#include "vdb_madf/method/detail/graph_metadata_type.h"

namespace vdb_madf {

namespace {

constexpr char kName[] = "madf_manifold_graph";  // of the metadata and of its type
constexpr uint32_t kVersion = 1;
constexpr size_t kHeaderBytes = 12, kNodeBytes = 24, kEdgeBytes = 21;
/// Read and written in pieces of about this size: a corrupt count then ends at the end of the file,
/// not in an allocation of its size.
constexpr size_t kBlockBytes = 1 << 16;

uint64_t byteCount(uint64_t nodes, uint64_t edges) {
  return kHeaderBytes + nodes * kNodeBytes + edges * kEdgeBytes;
}

/// The rule that the graph breaks; empty if none.
std::string brokenRule(const ManifoldGraph& graph) {
  const auto& nodes = graph.nodes;
  constexpr int64_t kMaxVoxels = int64_t(kMaxLeaves) * 512;
  for (size_t i = 0; i < nodes.size(); ++i) {
    if (nodes[i].squaredRadius < 0 || nodes[i].voxels < 0) return "a node has a negative size";
    if (nodes[i].voxels > kMaxVoxels) return "a node has more voxels than fit in a grid";
    for (int axis = 0; axis < 3; ++axis)
      if (std::abs(int64_t(nodes[i].position[axis])) > kMaxCoordinate)
        return "a node lies beyond the largest coordinate";
    if (i > 0 && !(nodes[i - 1].position < nodes[i].position)) return "its nodes are out of order";
  }
  const auto& edges = graph.edges;
  for (size_t i = 0; i < edges.size(); ++i) {
    if (edges[i].first >= edges[i].second || edges[i].second >= nodes.size())
      return "an edge joins nodes that do not exist";
    if (edges[i].contactFaces < 0) return "an edge has a negative size";
    if (i > 0 && !(std::pair(edges[i - 1].first, edges[i - 1].second) <
                   std::pair(edges[i].first, edges[i].second)))
      return "its edges are out of order";
  }
  return {};
}

/// Of the nodes, whose squared distances have to fit.
Coord extentOf(const ManifoldGraph& graph) {
  CoordBBox box;
  for (const ManifoldGraph::Node& node : graph.nodes) box.expand(node.position);
  return box.empty() ? Coord(0) : box.dim();
}

template <typename T>
char* put(char* to, T value) {
  const auto bits = std::make_unsigned_t<T>(value);
  for (size_t i = 0; i < sizeof(T); ++i) *to++ = char(uint64_t(bits) >> 8 * i & 0xff);
  return to;
}

template <typename T>
const char* get(const char* from, T& value) {
  uint64_t bits = 0;
  for (size_t i = 0; i < sizeof(T); ++i) bits |= uint64_t(uint8_t(*from++)) << 8 * i;
  value = T(bits);
  return from;
}

void putNode(char* to, const ManifoldGraph::Node& node) {
  for (int axis = 0; axis < 3; ++axis) to = put(to, node.position[axis]);
  to = put(to, node.squaredRadius);
  put(to, node.voxels);
}

ManifoldGraph::Node getNode(const char* from) {
  ManifoldGraph::Node node;
  for (int axis = 0; axis < 3; ++axis) from = get(from, node.position[axis]);
  from = get(from, node.squaredRadius);
  get(from, node.voxels);
  return node;
}

void putEdge(char* to, const ManifoldGraph::Edge& edge) {
  to = put(to, edge.first);
  to = put(to, edge.second);
  to = put(to, edge.contactFaces);
  to = put(to, edge.saddleHeight);
  put(to, uint8_t(edge.cellsTouch));
}

ManifoldGraph::Edge getEdge(const char* from) {
  ManifoldGraph::Edge edge;
  uint8_t cellsTouch = 0;
  from = get(from, edge.first);
  from = get(from, edge.second);
  from = get(from, edge.contactFaces);
  from = get(from, edge.saddleHeight);
  get(from, cellsTouch);
  if (cellsTouch > 1) throw std::runtime_error("the graph has a flag that is neither 0 nor 1");
  edge.cellsTouch = cellsTouch == 1;
  return edge;
}

/// A stream without exceptions only sets a flag.
void readBytes(std::istream& stream, char* to, size_t count) {
  if (!stream.read(to, std::streamsize(count))) throw std::runtime_error("the graph ends early");
}

template <typename Item>
std::vector<Item> readItems(std::istream& stream, size_t count, size_t itemBytes,
                            Item (*get)(const char*)) {
  std::vector<Item> items;
  std::vector<char> block;
  while (items.size() < count) {
    const size_t here = std::min(count - items.size(), kBlockBytes / itemBytes);
    block.resize(here * itemBytes);
    readBytes(stream, block.data(), block.size());
    for (size_t i = 0; i < here; ++i) items.push_back(get(&block[i * itemBytes]));
  }
  return items;
}

template <typename Item>
void writeItems(std::ostream& stream, const std::vector<Item>& items, size_t itemBytes,
                void (*put)(char*, const Item&)) {
  std::vector<char> block;
  for (size_t done = 0; done < items.size();) {
    const size_t here = std::min(items.size() - done, kBlockBytes / itemBytes);
    block.resize(here * itemBytes);
    for (size_t i = 0; i < here; ++i) put(&block[i * itemBytes], items[done + i]);
    stream.write(block.data(), std::streamsize(block.size()));
    done += here;
  }
}

/// Copies share the graph: OpenVDB copies metadata whenever it copies or writes a grid.
class GraphMetadata final : public openvdb::Metadata {
 public:
  GraphMetadata() = default;
  explicit GraphMetadata(ManifoldGraph graph)
      : graph_(std::make_shared<const ManifoldGraph>(std::move(graph))) {}

  static openvdb::Metadata::Ptr create() { return std::make_shared<GraphMetadata>(); }

  const ManifoldGraph& value() const { return *graph_; }
  openvdb::Name typeName() const override { return kName; }
  openvdb::Metadata::Ptr copy() const override {
    auto result = std::make_shared<GraphMetadata>();
    result->graph_ = graph_;
    return result;
  }
  void copy(const openvdb::Metadata& other) override {
    const auto* graph = dynamic_cast<const GraphMetadata*>(&other);
    if (!graph) OPENVDB_THROW(openvdb::TypeError, "not a manifold graph");
    graph_ = graph->graph_;
  }
  std::string str() const override {
    return std::to_string(graph_->nodes.size()) + " critical points, " +
           std::to_string(graph_->edges.size()) + " edges";
  }
  bool asBool() const override { return !graph_->nodes.empty(); }
  openvdb::Index32 size() const override {
    return openvdb::Index32(byteCount(graph_->nodes.size(), graph_->edges.size()));
  }

 protected:
  void readValue(std::istream& stream, openvdb::Index32 bytes) override {
    std::array<char, kHeaderBytes> header{};
    uint32_t version = 0, nodes = 0, edges = 0;
    if (bytes < header.size()) throw std::runtime_error("the graph ends early");
    readBytes(stream, header.data(), header.size());
    get(get(get(header.data(), version), nodes), edges);
    if (version != kVersion)
      throw std::runtime_error("the graph has the unknown version " + std::to_string(version));
    if (byteCount(nodes, edges) != bytes)
      throw std::runtime_error("the graph is not as long as its counts say");
    auto graph = std::make_shared<ManifoldGraph>();
    graph->nodes = readItems(stream, nodes, kNodeBytes, getNode);
    graph->edges = readItems(stream, edges, kEdgeBytes, getEdge);
    const std::string rule = brokenRule(*graph);
    if (!rule.empty()) throw std::runtime_error("the graph is wrong: " + rule);
    graph_ = std::move(graph);
  }

  void writeValue(std::ostream& stream) const override {
    std::array<char, kHeaderBytes> header{};
    put(put(put(header.data(), kVersion), uint32_t(graph_->nodes.size())),
        uint32_t(graph_->edges.size()));
    stream.write(header.data(), header.size());
    writeItems(stream, graph_->nodes, kNodeBytes, putNode);
    writeItems(stream, graph_->edges, kEdgeBytes, putEdge);
  }

 private:
  std::shared_ptr<const ManifoldGraph> graph_ = std::make_shared<const ManifoldGraph>();
};

}  // namespace

void setGraph(openvdb::GridBase& grid, ManifoldGraph graph) {
  const std::string rule = brokenRule(graph);
  if (!rule.empty()) throw InvalidInput("the manifold graph cannot be stored: " + rule);
  // OpenVDB keeps the size of a metadata value in 32 bits.
  if (byteCount(graph.nodes.size(), graph.edges.size()) > std::numeric_limits<uint32_t>::max())
    throw InvalidInput(
        "the manifold graph takes 4 GiB or more and cannot be stored: cut the "
        "volume, or do not keep the manifolds");
  grid.removeMeta(kName);
  setWeights(grid, graph.weights);
  grid.insertMeta(kName, GraphMetadata(std::move(graph)));
}

std::optional<ManifoldGraph> storedGraph(const openvdb::GridBase& grid) {
  const auto metadata = std::dynamic_pointer_cast<const GraphMetadata>(grid[kName]);
  if (!metadata) return std::nullopt;
  ManifoldGraph graph = metadata->value();
  graph.weights = storedWeights(grid);
  checkWeights(graph.weights, extentOf(graph));
  return graph;
}

ManifoldGraph requiredGraph(const openvdb::GridBase& grid) {
  std::optional<ManifoldGraph> graph = storedGraph(grid);
  if (!graph)
    throw InvalidInput("grid '" + grid.getName() + "' carries no graph of manifolds: segment again",
                       Hint::manifolds);
  return std::move(*graph);
}

void removeGraph(openvdb::GridBase& grid) {
  grid.removeMeta(kName);
}

void detail::registerGraphMetadata() {
  if (!openvdb::Metadata::isRegisteredType(kName))
    openvdb::Metadata::registerType(kName, GraphMetadata::create);
}

}  // namespace vdb_madf
