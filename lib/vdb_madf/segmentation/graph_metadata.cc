// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/segmentation/graph_metadata.h"

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
#include "vdb_madf/grids/grid_metadata.h"
#include "vdb_madf/method/boundary.h"
#include "vdb_madf/segmentation/detail/graph_metadata_type.h"

namespace vdb_madf {

namespace {

constexpr const char* kName = kGraphMetadata;  // of the metadata and of its type
constexpr size_t kHeaderBytes = 12, kNodeBytes = 24, kEdgeBytes = 21, kNumberBytes = 4,
                 kFlagBytes = 1, kCountBytes = 8;
/// Read and written in pieces of about this size: a corrupt count then ends at the end of the file,
/// not in an allocation of its size.
constexpr size_t kBlockBytes = 1 << 16;

/// What a value holds besides nodes and edges.
struct Layout {
  bool isPart = false, hasCavities = false;

  /// Versions 1 and 2 are a whole and a part without cavities, 3 and 4 those with some.
  uint32_t version() const { return 1 + uint32_t(isPart) + 2 * uint32_t(hasCavities); }
  static Layout ofVersion(uint32_t version) {
    if (version < 1 || version > 4)
      throw std::runtime_error("the graph has the unknown version " + std::to_string(version));
    return {version % 2 == 0, version > 2};
  }
  uint64_t byteCount(uint64_t nodes, uint64_t edges) const {
    const size_t more = (isPart ? kNumberBytes + kFlagBytes : 0) + (hasCavities ? kCountBytes : 0);
    return kHeaderBytes + nodes * (kNodeBytes + more) + edges * kEdgeBytes;
  }
};

Layout layoutOf(const ManifoldGraph& graph, bool isPart) {
  return {isPart, std::any_of(graph.nodes.begin(), graph.nodes.end(),
                              [](const CriticalPoint& node) { return node.cavityVoxels > 0; })};
}

/// The rule that the graph breaks; empty if none.
std::string brokenRule(const ManifoldGraph& graph) {
  const auto& nodes = graph.nodes;
  constexpr int64_t kMaxVoxels = int64_t(kMaxLeaves) * 512;
  for (size_t i = 0; i < nodes.size(); ++i) {
    if (nodes[i].squaredRadius < 0 || nodes[i].voxels < 0 || nodes[i].cavityVoxels < 0)
      return "a node has a negative size";
    if (nodes[i].voxels > kMaxVoxels || nodes[i].cavityVoxels > kMaxVoxels)
      return "a node has more voxels than fit in a grid";
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

std::string brokenRule(const GraphPart& part) {
  const auto& number = part.number;
  if (number.size() != part.graph.nodes.size() || part.goesOn.size() != number.size())
    return "not all nodes have a number";
  for (size_t i = 0; i < number.size(); ++i)
    if (number[i] < 1 || number[i] > uint32_t(std::numeric_limits<int32_t>::max()) ||
        (i > 0 && number[i] <= number[i - 1]))
      return "its numbers are out of order";
  return brokenRule(part.graph);
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

template <typename T>
void putNumber(char* to, const T& number) {
  put(to, number);
}
template <typename T>
T getNumber(const char* from) {
  T number = 0;
  get(from, number);
  return number;
}

void putFlag(char* to, const char& flag) {
  *to = flag;
}
char getFlag(const char* from) {
  if (*from != 0 && *from != 1)
    throw std::runtime_error("the graph has a flag that is neither 0 nor 1");
  return *from;
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

/// A graph, or a part of one. Copies share it: OpenVDB copies metadata whenever it copies or writes
/// a grid.
class GraphMetadata final : public openvdb::Metadata {
 public:
  GraphMetadata() = default;
  GraphMetadata(GraphPart part, bool isPart)
      : part_(std::make_shared<const GraphPart>(std::move(part))), isPart_(isPart) {}

  static openvdb::Metadata::Ptr create() { return std::make_shared<GraphMetadata>(); }

  const GraphPart& value() const { return *part_; }  ///< of a whole graph, without numbers
  bool isPart() const { return isPart_; }
  openvdb::Name typeName() const override { return kName; }
  openvdb::Metadata::Ptr copy() const override {
    auto result = std::make_shared<GraphMetadata>();
    result->part_ = part_;
    result->isPart_ = isPart_;
    return result;
  }
  void copy(const openvdb::Metadata& other) override {
    const auto* graph = dynamic_cast<const GraphMetadata*>(&other);
    if (!graph) OPENVDB_THROW(openvdb::TypeError, "not a manifold graph");
    part_ = graph->part_;
    isPart_ = graph->isPart_;
  }
  std::string str() const override {
    const ManifoldGraph& graph = part_->graph;
    return std::to_string(graph.nodes.size()) + " critical points, " +
           std::to_string(graph.edges.size()) + " edges" + (isPart_ ? " in a slab" : "");
  }
  bool asBool() const override { return !part_->graph.nodes.empty(); }
  openvdb::Index32 size() const override {
    const ManifoldGraph& graph = part_->graph;
    return openvdb::Index32(
        layoutOf(graph, isPart_).byteCount(graph.nodes.size(), graph.edges.size()));
  }

 protected:
  void readValue(std::istream& stream, openvdb::Index32 bytes) override {
    std::array<char, kHeaderBytes> header{};
    uint32_t version = 0, nodes = 0, edges = 0;
    if (bytes < header.size()) throw std::runtime_error("the graph ends early");
    readBytes(stream, header.data(), header.size());
    get(get(get(header.data(), version), nodes), edges);
    const Layout layout = Layout::ofVersion(version);
    if (layout.byteCount(nodes, edges) != bytes)
      throw std::runtime_error("the graph is not as long as its counts say");
    auto part = std::make_shared<GraphPart>();
    part->graph.nodes = readItems(stream, nodes, kNodeBytes, getNode);
    part->graph.edges = readItems(stream, edges, kEdgeBytes, getEdge);
    if (layout.isPart) {
      part->number = readItems(stream, nodes, kNumberBytes, getNumber<uint32_t>);
      part->goesOn = readItems(stream, nodes, kFlagBytes, getFlag);
    }
    if (layout.hasCavities) {
      const auto counts = readItems(stream, nodes, kCountBytes, getNumber<int64_t>);
      for (size_t i = 0; i < nodes; ++i) part->graph.nodes[i].cavityVoxels = counts[i];
    }
    const std::string rule = layout.isPart ? brokenRule(*part) : brokenRule(part->graph);
    if (!rule.empty()) throw std::runtime_error("the graph is wrong: " + rule);
    part_ = std::move(part);
    isPart_ = layout.isPart;
  }

  void writeValue(std::ostream& stream) const override {
    std::array<char, kHeaderBytes> header{};
    const Layout layout = layoutOf(part_->graph, isPart_);
    put(put(put(header.data(), layout.version()), uint32_t(part_->graph.nodes.size())),
        uint32_t(part_->graph.edges.size()));
    stream.write(header.data(), header.size());
    writeItems(stream, part_->graph.nodes, kNodeBytes, putNode);
    writeItems(stream, part_->graph.edges, kEdgeBytes, putEdge);
    writeItems(stream, part_->number, kNumberBytes, putNumber<uint32_t>);
    writeItems(stream, part_->goesOn, kFlagBytes, putFlag);
    if (!layout.hasCavities) return;
    std::vector<int64_t> counts;
    for (const CriticalPoint& node : part_->graph.nodes) counts.push_back(node.cavityVoxels);
    writeItems(stream, counts, kCountBytes, putNumber<int64_t>);
  }

 private:
  std::shared_ptr<const GraphPart> part_ = std::make_shared<const GraphPart>();
  bool isPart_ = false;
};

void store(openvdb::GridBase& grid, GraphPart part, bool isPart) {
  const std::string rule = isPart ? brokenRule(part) : brokenRule(part.graph);
  if (!rule.empty()) throw InvalidInput("the manifold graph cannot be stored: " + rule);
  // OpenVDB keeps the size of a metadata value in 32 bits.
  if (layoutOf(part.graph, isPart).byteCount(part.graph.nodes.size(), part.graph.edges.size()) >
      std::numeric_limits<uint32_t>::max())
    throw InvalidInput(
        "the manifold graph takes 4 GiB or more and cannot be stored: cut the "
        "volume, or do not keep the manifolds");
  grid.removeMeta(kName);
  setWeights(grid, part.graph.weights);
  grid.insertMeta(kName, GraphMetadata(std::move(part), isPart));
}

std::shared_ptr<const GraphMetadata> metadataOf(const openvdb::GridBase& grid) {
  return std::dynamic_pointer_cast<const GraphMetadata>(grid[kName]);
}

/// Gives a graph that was stored on a grid its weights and its place in the domain.
void takeMetric(const openvdb::GridBase& grid, ManifoldGraph& graph) {
  graph.weights = storedWeights(grid);
  checkWeights(graph.weights, extentOf(graph));
  if (const auto domain = storedDomain(grid))
    placeGraph(graph, *domain, storedBoundary(grid) == Boundary::open);
}

}  // namespace

void setGraph(openvdb::GridBase& grid, ManifoldGraph graph) {
  store(grid, {std::move(graph), {}, {}}, false);
}

std::optional<ManifoldGraph> storedGraph(const openvdb::GridBase& grid) {
  const auto metadata = metadataOf(grid);
  if (!metadata) return std::nullopt;
  if (metadata->isPart())
    throw InvalidInput("grid '" + grid.getName() +
                       "' carries the graph of one slab: give the whole folder of slabs");
  ManifoldGraph graph = metadata->value().graph;
  takeMetric(grid, graph);
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

void setGraphPart(openvdb::GridBase& grid, GraphPart part) {
  store(grid, std::move(part), true);
}

std::optional<GraphPart> storedGraphPart(const openvdb::GridBase& grid) {
  const auto metadata = metadataOf(grid);
  if (!metadata || !metadata->isPart()) return std::nullopt;
  GraphPart part = metadata->value();
  takeMetric(grid, part.graph);
  return part;
}

std::optional<ManifoldGraph> storedGraph(const LabelSlabs& manifolds, Interrupter* interrupter) {
  std::vector<GraphPart> parts;
  for (size_t slab = 0; slab < manifolds.slabCount(); ++slab)
    if (auto part = storedGraphPart(*manifolds.read(slab, interrupter)))
      parts.push_back(std::move(*part));
  if (parts.empty()) return std::nullopt;
  return joinedGraph(parts);
}

void detail::registerGraphMetadata() {
  if (!openvdb::Metadata::isRegisteredType(kName))
    openvdb::Metadata::registerType(kName, GraphMetadata::create);
}

}  // namespace vdb_madf
