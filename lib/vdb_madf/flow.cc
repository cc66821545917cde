// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/flow.h"

#include <algorithm>
#include <utility>

#include "vdb_madf/detail/parallel.h"
#include "vdb_madf/detail/voxels.h"

namespace vdb_madf {

namespace {

/// Other threads may shorten a voxel's path while this one reads it; both values lead to one root.
VoxelId load(const VoxelArray<VoxelId>& site, VoxelId p) {
  return __atomic_load_n(&site[p], __ATOMIC_RELAXED);
}

/// Points every voxel at its critical point; collects these and the voxels of their own cells.
VoxelSet jumpToRoots(const LeafIndex& index, VoxelArray<VoxelId>& site, VoxelSet& direct,
                     Interrupter* interrupter) {
  VoxelSet critical(index.leafCount());
  detail::parallelFor(index.leafCount(), detail::kLeafGrain, interrupter,
                      [&](size_t begin, size_t end) {
                        detail::forEachVoxel(index, begin, end, [&](VoxelId p) {
                          const VoxelId first = load(site, p);
                          VoxelId root = load(site, first);
                          if (root == first) {
                            direct.insert(p);  // a word belongs to one leaf, so to one thread
                            if (first == p) critical.insert(p);
                            return;
                          }
                          for (VoxelId next; (next = load(site, root)) != root;) root = next;
                          __atomic_store_n(&site[p], root, __ATOMIC_RELAXED);
                        });
                      });
  critical.rankMembers();
  return critical;
}

}  // namespace

Flow flow(const LeafIndex& index, VoxelArray<VoxelId> site, const VoxelArray<int32_t>& power,
          Interrupter* interrupter) {
  Flow result;
  result.direct = VoxelSet(index.leafCount());
  const VoxelSet critical = jumpToRoots(index, site, result.direct, interrupter);

  const std::vector<VoxelId> ids = critical.members();
  std::vector<uint32_t> order(ids.size());
  for (uint32_t i = 0; i < order.size(); ++i) order[i] = i;
  std::sort(order.begin(), order.end(),
            [&](uint32_t a, uint32_t b) { return index.coord(ids[a]) < index.coord(ids[b]); });
  std::vector<uint32_t> numberOfRank(ids.size());
  result.criticalPoints.resize(ids.size());
  for (uint32_t i = 0; i < order.size(); ++i) {
    numberOfRank[order[i]] = i + 1;
    // At a fixed point the power is -D.
    result.criticalPoints[i] = {index.coord(ids[order[i]]), -power[ids[order[i]]], 0};
  }

  detail::parallelFor(
      index.leafCount(), detail::kLeafGrain, interrupter, [&](size_t begin, size_t end) {
        VoxelId root = 0;
        uint32_t number = 0;
        int64_t run = 0;
        const auto flush = [&] {
          if (run > 0)
            __atomic_fetch_add(&result.criticalPoints[number - 1].voxels, run, __ATOMIC_RELAXED);
        };
        for (size_t leaf = begin; leaf < end; ++leaf) {
          for (size_t x = 0; x < 8; ++x) {
            const uint64_t word = index.mask(leaf)[x];
            VoxelId* values = site.data() + leaf * 512 + x * 64;
            for (int bit = 0; bit < 64; ++bit) {
              if (!(word >> bit & 1)) {
                values[bit] = 0;
                continue;
              }
              if (number == 0 || values[bit] != root) {
                flush();
                root = values[bit];
                number = numberOfRank[critical.rank(root)];
                run = 0;
              }
              ++run;
              values[bit] = number;
            }
          }
        }
        flush();
      });
  result.manifold = std::move(site);
  return result;
}

}  // namespace vdb_madf
