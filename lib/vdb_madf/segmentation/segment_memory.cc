// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/segmentation/segment_memory.h"

#include <openvdb/tree/LeafManager.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "vdb_madf/base/detail/thread_count.h"
#include "vdb_madf/grids/grid_metadata.h"
#include "vdb_madf/method/merge.h"

namespace vdb_madf {

namespace {

constexpr int kBlockSide = 64;  // of a sampled block, voxels
constexpr int kBlocks = 8;
constexpr int64_t kLeavesOfBlock = kBlockSide * kBlockSide * kBlockSide / 512;

// Bytes per leaf node.
constexpr double kIndex = 460;  // index, masks, neighbors, sets of voxels
constexpr double kGrid = 2328;  // an Int32 leaf as the heap holds it, and its share of the tree
constexpr double kMeasure = 1700;

// Bytes per voxel, and while voxels without a ball get one.
constexpr double kPerVoxel = 4, kCompletion = 0.6;

// Bytes of each item of a size, measured where it is many.
constexpr double kCavity = 180, kBallTable = 20, kBallList = 24, kFilter = 25, kKeptBall = 150,
                 kFlow = 64, kPoint = 40, kEdge = 32, kStoredPoint = 32, kStoredEdge = 44,
                 kClass = 20, kCluster = 130, kContact = 60, kPart = 280, kGrainRow = 1700,
                 kBondRow = 700;

// The program itself, what each thread has of its own, and what the allocator keeps.
constexpr double kProgram = 56 << 20, kThread = 2 << 20, kAllocator = 1.08;

int64_t withOther(double bytes) {
  return int64_t(kProgram + kThread * double(detail::threadCount()) + kAllocator * bytes);
}

/// The totals that a sample has to tell.
constexpr int64_t ObjectSize::*kSampled[] = {
    &ObjectSize::cavities,  &ObjectSize::balls,  &ObjectSize::ballLeaves,
    &ObjectSize::keptBalls, &ObjectSize::points, &ObjectSize::edges,
    &ObjectSize::grains,    &ObjectSize::parts,  &ObjectSize::bonds};

ObjectSize countedSize(const MaskGrid& object) {
  const MaskTree& tree = object.constTree();
  ObjectSize size;
  size.voxels = int64_t(tree.activeVoxelCount());
  const int64_t inTiles = size.voxels - int64_t(tree.activeLeafVoxelCount());
  size.leaves = int64_t(tree.leafCount()) + inTiles / 512;
  return size;
}

/// Adds what segmenting this object finds.
void addTotals(const MaskGrid& object, SegmentOptions options, ObjectSize& size) {
  options.maxMemory = 0;
  options.keepDistance = options.keepPower = options.keepManifold = false;
  options.tidy = 0;
  const Segmentation s = segment(object, options);
  size.cavities = s.counts.cavities;
  size.balls = s.counts.medialBalls;
  size.keptBalls = s.counts.keptBalls;
  size.points = s.counts.criticalPoints;
  size.edges = int64_t(s.graph.edges.size());
  size.grains = s.counts.grains;
  for (auto leaf = s.grain->constTree().cbeginLeaf(); leaf; ++leaf) {
    std::set<int32_t> labels;
    for (auto value = leaf->cbeginValueOn(); value; ++value) labels.insert(*value);
    size.parts += int64_t(labels.size());
  }
  std::set<Coord> leaves;
  for (const MedialBall& ball : s.balls) leaves.insert(ball.center & ~7);
  size.ballLeaves = int64_t(leaves.size());
  const std::vector<int32_t> grainOf = merge(s.graph, options.merge).grainOfNode;
  std::vector<std::pair<int32_t, int32_t>> bonds;
  for (const ManifoldGraph::Edge& edge : s.graph.edges) {
    const auto [low, high] = std::minmax(grainOf[edge.first], grainOf[edge.second]);
    if (low > 0 && low != high) bonds.emplace_back(low, high);
  }
  std::sort(bonds.begin(), bonds.end());
  size.bonds = std::unique(bonds.begin(), bonds.end()) - bonds.begin();
}

/// The cube from a corner on, within the domain; with a layer beyond each of the domain's faces
/// that is closed, as background.
CoordBBox blockAt(const Coord& corner, const std::optional<Domain>& domain, Boundary boundary) {
  CoordBBox block = CoordBBox::createCube(corner, kBlockSide);
  if (!domain) return block;
  block.intersect(domain->box());
  for (int axis = 0; axis < 3 && boundary == Boundary::closed; ++axis) {
    if (block.min()[axis] == domain->box().min()[axis]) --block.min()[axis];
    if (block.max()[axis] == domain->box().max()[axis]) ++block.max()[axis];
  }
  return block;
}

/// The object within the block, as a domain that cuts it.
MaskGrid::Ptr blockOf(const MaskGrid& object, const CoordBBox& block) {
  const MaskGrid::Ptr part = MaskGrid::create();
  part->setTransform(object.transform().copy());
  setDomain(*part, block);
  const MaskTree& tree = object.constTree();
  const Coord first = block.min() & ~7;
  for (int x = first.x(); x <= block.max().x(); x += 8)
    for (int y = first.y(); y <= block.max().y(); y += 8)
      for (int z = first.z(); z <= block.max().z(); z += 8)
        if (const auto* leaf = tree.probeConstLeaf({x, y, z}))
          part->tree().addLeaf(new MaskTree::LeafNodeType(*leaf));
        else if (tree.isValueOn({x, y, z}))
          part->tree().touchLeaf({x, y, z})->setValuesOn();
  return part;
}

}  // namespace

ObjectSize sizeAtMost(const MaskGrid& object, const SegmentOptions& options) {
  ObjectSize size = countedSize(object);
  for (const auto total : kSampled) size.*total = size.voxels;
  size.edges = size.bonds = 3 * size.voxels;
  size.ballLeaves = options.keepBalls ? size.leaves : 0;
  return size;
}

ObjectSize sampledSize(const MaskGrid& object, const SegmentOptions& options) {
  ObjectSize size = countedSize(object);
  const openvdb::tree::LeafManager<const MaskTree> leaves(object.constTree());
  const size_t leafCount = leaves.leafCount();
  if (size.voxels == 0) return size;
  if (leafCount <= kBlocks * kLeavesOfBlock) {
    addTotals(object, options, size);
    return size;
  }
  SegmentOptions within = options;
  within.boundary = Boundary::open;
  const std::optional<Domain> domain = storedDomain(object);
  // A block is met as often as it has leaf nodes: what it holds for each of them is, in the mean,
  // what the object holds.
  std::array<ObjectSize, kBlocks> found;
  std::array<double, kBlocks> scale{};
  for (size_t i = 0; i < kBlocks; ++i) {
    const Coord origin = leaves.leaf(leafCount * (2 * i + 1) / (2 * kBlocks)).origin();
    const CoordBBox block = blockAt(origin & ~(kBlockSide - 1), domain, options.boundary);
    const MaskGrid::Ptr part = blockOf(object, block);
    scale[i] = double(leafCount) / double(part->constTree().leafCount());
    const bool isSolid = part->constTree().activeVoxelCount() == block.volume();
    if (!isSolid) addTotals(*part, within, found[i]);  // there is nothing but depth
  }
  for (const auto total : kSampled) {
    double sum = 0, squares = 0;
    for (size_t i = 0; i < kBlocks; ++i) {
      const double ofBlock = scale[i] * double(found[i].*total);
      sum += ofBlock;
      squares += ofBlock * ofBlock;
    }
    const double mean = sum / kBlocks;
    const double error = std::sqrt((squares / kBlocks - mean * mean) / (kBlocks - 1));
    size.*total = int64_t(mean + 2 * (error > 0 ? error : 0));
  }
  return size;
}

int64_t segmentMemory(const ObjectSize& size, const SegmentOptions& options) {
  const bool isFiltered = options.gamma > 1;
  const auto leaves = double(size.leaves), points = double(size.points), edges = double(size.edges),
             grains = double(size.grains);
  const double voxels = double(size.voxels + size.cavities);
  const double grid = kGrid * leaves;
  // What lives until the end, and in each stage the most of what lives beside it.
  double kept = kIndex * leaves;
  double peak = kept + kCavity * double(size.cavities);
  if (options.keepDistance) kept += grid;
  double maps = 2 * kPerVoxel * voxels;  // power and sites, later manifolds
  if (isFiltered || options.keepBalls) maps += kBallTable * double(size.balls);
  if (options.keepBalls) kept += kBallList * double(size.balls);
  if (isFiltered)
    peak = std::max(peak, kept + maps + kFilter * double(size.balls) +
                              kKeptBall * double(size.keptBalls) + kCompletion * voxels);
  peak = std::max(peak, kept + maps + kFlow * points);
  maps = 2 * kPerVoxel * voxels;
  peak = std::max(peak, kept + maps + 2 * (kPoint * points + kEdge * edges));
  if (options.keepPower) kept += grid;
  if (options.keepManifold) kept += grid;
  kept += kPoint * points + kEdge * edges;
  maps = kPerVoxel * voxels;
  const double joining =
      options.merge.mode == MergeMode::score ? kCluster * grains + kContact * edges : 0;
  peak = std::max(peak, kept + maps + kClass * points + joining);
  // Masks of labels, and the pieces of these; what joined the grains is not all given back.
  kept += kPart * double(size.parts);
  if (options.merge.mode == MergeMode::score) kept += kCluster * grains;
  peak = std::max(peak, kept + maps);
  // The labels' grid grows while the manifolds shrink.
  if (options.keepManifold) kept += kStoredPoint * points + kStoredEdge * edges;
  peak = std::max(peak, kept + std::max(maps, grid));
  if (options.keepBalls) peak = std::max(peak, kept + grid + 2 * kGrid * double(size.ballLeaves));
  return withOther(peak);
}

int64_t tablesMemory(const ObjectSize& size, const SegmentOptions& options) {
  double bytes = (kGrid + kMeasure) * double(size.leaves) + kPoint * double(size.points) +
                 kEdge * double(size.edges) + kGrainRow * double(size.grains) +
                 kBondRow * double(size.bonds);
  for (const bool isKept : {options.keepDistance, options.keepPower, options.keepManifold})
    if (isKept) bytes += kGrid * double(size.leaves);
  return withOther(bytes);
}

}  // namespace vdb_madf
