// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/segmentation/segment_memory.h"

#include <openvdb/tree/LeafManager.h>

#include <algorithm>
#include <atomic>

#include "vdb_madf/base/detail/parallel.h"
#include "vdb_madf/leaves/detail/leaf_mask.h"
#include "vdb_madf/leaves/detail/voxels.h"

namespace vdb_madf {

namespace {

// Bytes per leaf.
constexpr double kIndex = 128;    // origin, mask, neighbors, ranks
constexpr double kVoxelSet = 96;  // one bit per voxel, and ranks
constexpr double kGrid = 2328;    // an Int32 leaf as the heap holds it, and its share of the tree
constexpr double kPieces = 165;   // connected pieces within leaves, of the object or of labels

// Bytes per object voxel.
constexpr double kPower = 4, kSite = 4, kManifold = 4;
// Medial balls are 1 to 8 % of the voxels, and all of thin structures: their ids and roots, or
// cells and radii, of 4 bytes each.
constexpr double kBallShare = 0.08, kBalls = 12, kBallTable = 16, kBallList = 48;
// Voxels that change in one round of the geodesic completion, 12 bytes each in growing lists.
constexpr double kCompletion = 0.12 * 24;

// Critical points, in the graph and what makes it: of thin structures nearly each voxel is one, but
// for those that the filter drops; of others next to none.
constexpr double kGraph = 120, kFilteredShare = 0.25;
// Each of them while the graph is made and merged.
constexpr double kMaking = 270;
// Of the angle's grains there are more, and so many leaves more that each lies in.
constexpr double kLeavesOfPoint = 2.25;

// Measures and tables, per grain, and per leaf: faces and surfaces.
constexpr double kTables = 1300, kMeasure = 2000;
// Of the angle's crumbs, with their bonds: of snow nearly each critical point of thin structures is
// one, of balls few are, and of them the filter leaves up to half.
constexpr double kCrumbTables = 2600, kFilteredCrumbs = 0.5;

// Threads' scratch space and stacks, the graph, code.
constexpr double kBase = 60 << 20;
// Blocks are rounded up to huge pages, and the allocator keeps some of what was freed.
constexpr double kKept = 0.15;

/// The voxels at the faces of a leaf.
constexpr uint64_t kRows = detail::kFirstY | detail::kLastY | detail::kFirstZ | detail::kLastZ;
constexpr LeafIndex::Mask kAtFaces{~0ull, kRows, kRows, kRows, kRows, kRows, kRows, ~0ull};

}  // namespace

ObjectSize objectSize(const MaskGrid& object) {
  const MaskTree& tree = object.constTree();
  ObjectSize size;
  size.leaves = int64_t(tree.leafCount());
  size.voxels = int64_t(tree.activeVoxelCount());
  size.leaves += (size.voxels - int64_t(tree.activeLeafVoxelCount())) / 512;
  const openvdb::tree::LeafManager<const MaskTree> leaves(tree);
  std::atomic<int64_t> thin{0}, pieces{0}, inside{0};
  detail::parallelForEach(leaves.leafCount(), detail::kLeafGrain, nullptr, [&](size_t i) {
    const LeafIndex::Mask mask = detail::maskOf(leaves.leaf(i));
    const int64_t ofLeaf = detail::countThin(mask);
    if (ofLeaf == 0) return;
    thin += ofLeaf;
    detail::forEachPiece(mask, [&](const LeafIndex::Mask& piece) {
      ++pieces;
      inside += !detail::meet(piece, kAtFaces);
    });
  });
  size.thin = thin;
  size.pieces = pieces;
  size.specks = inside * 512 / 216;
  return size;
}

int64_t tablesMemory(const ObjectSize& size, const SegmentOptions& options) {
  double tables = kTables * double(size.specks);
  if (options.merge.mode == MergeMode::angle)
    tables = std::max(tables,
                      kCrumbTables * double(size.thin) * (options.gamma > 1 ? kFilteredCrumbs : 1));
  return int64_t(kBase + (kIndex + kGrid + kMeasure) * double(size.leaves) +
                 kGraph * double(size.thin) + tables);
}

int64_t segmentMemory(const ObjectSize& size, const SegmentOptions& options) {
  const bool filter = options.gamma > 1;
  const double leaves = double(size.leaves), voxels = double(size.voxels);
  const double perGrid = kGrid * leaves;
  const double ballCount = kBallShare * voxels + double(size.thin);
  // What lives until the end.
  double kept = kBase + kIndex * leaves;
  if (options.keepDistance) kept += perGrid;

  double peak = kept + (kPower + kSite) * voxels;  // power map
  if (options.keepBalls) kept += kBallList * ballCount;
  double sets = kVoxelSet * leaves;
  double balls = kBalls * ballCount;
  if (filter) {
    sets += (kVoxelSet + kPieces) * leaves;
    balls += kBallTable * ballCount;
    peak = std::max(peak, kept + (kPower + kSite + kCompletion) * voxels + balls + sets +
                              2 * kVoxelSet * leaves);
  }
  peak = std::max(peak, kept + (kPower + kSite) * voxels + balls + sets);  // flow
  const double points = double(size.thin) * (filter ? kFilteredShare : 1);
  peak = std::max(peak, kept + (kPower + kManifold) * voxels + sets + kMaking * points);
  kept += kGraph * points;
  if (options.keepPower) {
    kept += perGrid;
    peak = std::max(peak, kept + (kPower + kManifold) * voxels + sets);
  }
  if (options.keepManifold) kept += perGrid;
  // tidy: masks of labels, and pieces of them
  double parts = std::max(leaves, double(size.pieces));
  if (options.merge.mode == MergeMode::angle) parts += kLeavesOfPoint * points;
  peak = std::max(peak, kept + sets + kManifold * voxels + 2 * kPieces * parts);
  // The labels' grid grows while the manifolds shrink.
  peak = std::max(peak, kept + sets + std::max(kManifold * voxels, perGrid));
  if (options.keepManifold) peak = std::max(peak, kept + sets + kManifold * voxels);
  if (options.keepBalls) peak = std::max(peak, kept + 3 * perGrid);  // written as two grids
  return int64_t(peak + kKept * (peak - kBase));
}

}  // namespace vdb_madf
