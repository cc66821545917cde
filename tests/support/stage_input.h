// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <algorithm>
#include <vector>

#include "support/by_rank.h"
#include "support/oracle.h"
#include "vdb_madf/leaves/voxel_set.h"
#include "vdb_madf/method/medial_balls.h"

/// What the oracle found in the form that the stages take: each is tested by itself.
namespace vdb_madf::test {

/// kUncovered where the oracle has no site.
inline PowerMap toPowerMap(const LeafIndex& index, const OraclePower& power) {
  const auto siteAt = [&](const Coord& p) { return power.site[p]; };
  return {byRank<int32_t>(
              index,
              [&](const Coord& p) { return siteAt(p) == kNoSite ? kUncovered : power.power[p]; }),
          byRank<VoxelId>(index, [&](const Coord& p) {
            return siteAt(p) == kNoSite ? 0 : idOf(index, power.site.coord(siteAt(p)));
          })};
}

inline VoxelSet toVoxelSet(const LeafIndex& index, const std::vector<Coord>& voxels) {
  VoxelSet set(index.leafCount());
  for (const Coord& p : voxels) set.insert(idOf(index, p));
  set.rankMembers();
  return set;
}

/// Coordinates of the members, in lexicographic order.
inline std::vector<Coord> coordsOf(const LeafIndex& index, const VoxelSet& set) {
  std::vector<Coord> coords;
  for (const VoxelId id : set.members()) coords.push_back(index.coord(id));
  std::sort(coords.begin(), coords.end());
  return coords;
}

}  // namespace vdb_madf::test
