// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/method/flow.h"

#include <utility>

#include "vdb_madf/base/detail/parallel.h"
#include "vdb_madf/base/detail/simd.h"
#include "vdb_madf/leaves/detail/voxels.h"

namespace vdb_madf {

namespace {

/// Follows the sites from ball to ball: the critical ball that each one flows to, by rank. All
/// balls of a path that was walked get its end, so that long paths are walked once. Other threads
/// may shorten a path meanwhile; all lead to one root.
std::vector<uint32_t> rootBalls(const LeafIndex& index, const VoxelArray<VoxelId>& site,
                                const VoxelSet& balls, const std::vector<VoxelId>& ids,
                                Interrupter* interrupter) {
  constexpr size_t kBallGrain = 4096;
  std::vector<uint32_t> next(ids.size());
  detail::parallelFor(ids.size(), kBallGrain, interrupter, [&](size_t begin, size_t end) {
    detail::atBestLevel([&]() VDB_MADF_INLINE {
      for (size_t i = begin; i < end; ++i)
        next[i] = index.isForeign(ids[i]) ? uint32_t(i) : balls.rank(site[index.rank(ids[i])]);
    });
  });
  detail::parallelFor(ids.size(), kBallGrain, interrupter, [&](size_t begin, size_t end) {
    const auto load = [&](size_t i) { return __atomic_load_n(&next[i], __ATOMIC_RELAXED); };
    for (size_t i = begin; i < end; ++i) {
      uint32_t root = load(i);
      for (uint32_t further; (further = load(root)) != root;) root = further;
      for (uint32_t at = uint32_t(i), further; (further = load(at)) != root; at = further)
        __atomic_store_n(&next[at], root, __ATOMIC_RELAXED);
    }
  });
  return next;
}

/// The ranks of the fixed points among the balls, in lexicographic order of position.
std::vector<uint32_t> fixedPoints(const LeafIndex& index, const std::vector<VoxelId>& ids,
                                  const std::vector<uint32_t>& root) {
  std::vector<uint32_t> fixed;
  for (uint32_t i = 0; i < ids.size(); ++i)
    if (root[i] == i) fixed.push_back(i);
  detail::parallelSort(fixed.begin(), fixed.end(), [&](uint32_t a, uint32_t b) {
    return index.coord(ids[a]) < index.coord(ids[b]);
  });
  return fixed;
}

/// What Flow::manifold holds for the voxels of each ball's cell.
std::vector<uint32_t> manifoldOfBall(const std::vector<uint32_t>& root,
                                     const std::vector<uint32_t>& fixed) {
  std::vector<uint32_t> manifold(root.size());
  for (uint32_t i = 0; i < fixed.size(); ++i) manifold[fixed[i]] = (i + 1) | Flow::kOwnCell;
  for (uint32_t i = 0; i < root.size(); ++i)
    if (root[i] != i) manifold[i] = manifold[root[i]] & ~Flow::kOwnCell;
  return manifold;
}

/// Counts the voxels of manifolds for one thread: a few at a time, since neighbors share theirs.
class VoxelCounts {
 public:
  explicit VoxelCounts(std::vector<CriticalPoint>& points) : points_(points) {}

  void add(uint32_t point, int64_t voxels) {
    Slot& slot = slots_[point % kSlots];
    if (slot.point != point) {
      flush(slot);
      slot = {point, 0};
    }
    slot.voxels += voxels;
  }
  void flushAll() {
    for (Slot& slot : slots_) flush(slot);
  }

 private:
  static constexpr uint32_t kSlots = 256;
  struct Slot {
    uint32_t point = 0;
    int64_t voxels = 0;
  };
  void flush(Slot& slot) {
    if (slot.voxels > 0)
      __atomic_fetch_add(&points_[slot.point].voxels, slot.voxels, __ATOMIC_RELAXED);
    slot.voxels = 0;
  }

  std::vector<CriticalPoint>& points_;
  Slot slots_[kSlots];
};

/// Replaces the sites of a leaf's voxels by their manifolds. Neighbors along z mostly share their
/// ball: it is looked up once a run. No branch waits for what is looked up, so that many look-ups
/// overlap.
VDB_MADF_KERNEL size_t replaceRuns(const VoxelSet& balls, const uint32_t* manifold, size_t count,
                                   uint32_t* values, uint32_t* last, uint32_t* number) {
  uint16_t runOf[512];
  size_t runs = 0;
  for (size_t i = 0; i < count; ++i) {  // the next voxel overwrites what is no end of a run
    runOf[i] = uint16_t(runs);
    last[runs] = uint32_t(i);
    number[runs] = values[i];
    runs += i + 1 == count || values[i + 1] != values[i];
  }
  for (size_t r = 0; r < runs; ++r) number[r] = balls.rank(number[r]);
  for (size_t r = 0; r < runs; ++r) number[r] = manifold[number[r]];
  for (size_t i = 0; i < count; ++i) values[i] = number[runOf[i]];
  return runs;
}

void replaceInLeaf(const VoxelSet& balls, const std::vector<uint32_t>& manifold, uint32_t* values,
                   size_t count, VoxelCounts& voxels) {
  uint32_t last[513], number[513];  // of each run
  const size_t runs = detail::atBestLevel([&]() VDB_MADF_INLINE {
    return replaceRuns(balls, manifold.data(), count, values, last, number);
  });
  uint32_t begin = 0;
  for (size_t r = 0; r < runs; ++r) {
    voxels.add((number[r] & ~Flow::kOwnCell) - 1, last[r] + 1 - begin);
    begin = last[r] + 1;
  }
}

/// Replaces each voxel's site by its manifold, and counts the voxels of each manifold.
void replaceSites(const LeafIndex& index, const VoxelSet& balls,
                  const std::vector<uint32_t>& manifold, VoxelArray<VoxelId>& site,
                  std::vector<CriticalPoint>& criticalPoints, Interrupter* interrupter) {
  detail::parallelFor(index.leafCount(), detail::kLeafGrain, interrupter,
                      [&](size_t begin, size_t end) {
                        VoxelCounts voxels(criticalPoints);
                        for (size_t leaf = begin; leaf < end; ++leaf)
                          replaceInLeaf(balls, manifold, site.data() + index.firstRank(leaf),
                                        index.leafVoxels(leaf), voxels);
                        voxels.flushAll();
                      });
}

}  // namespace

Flow flow(const LeafIndex& index, VoxelArray<VoxelId> site, const VoxelArray<int32_t>& power,
          const VoxelSet& balls, Interrupter* interrupter) {
  const std::vector<VoxelId> ids = balls.members();
  const std::vector<uint32_t> root = rootBalls(index, site, balls, ids, interrupter);
  const std::vector<uint32_t> fixed = fixedPoints(index, ids, root);
  Flow result;
  result.criticalPoints.reserve(fixed.size());
  for (const uint32_t i : fixed)  // at a fixed point the power is -D
    result.criticalPoints.push_back(
        {index.coord(ids[i]), index.isForeign(ids[i]) ? 0 : -power[index.rank(ids[i])], 0});
  replaceSites(index, balls, manifoldOfBall(root, fixed), site, result.criticalPoints, interrupter);
  result.manifold = std::move(site);
  return result;
}

}  // namespace vdb_madf
