// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <optional>
#include <unordered_map>
#include <vector>

#include "vdb_madf/leaves/voxel_set.h"
#include "vdb_madf/method/power_map.h"

namespace vdb_madf::detail {

constexpr VoxelId kNoSite = ~VoxelId(0);

/// Gives the voxels that no kept ball covers a site, in the synchronous rounds of
/// filteredPowerMap().
class GeodesicCompletion {
 public:
  struct State {
    VoxelId site;  ///< kNoSite: none yet
    int32_t power;
  };
  struct Change {
    VoxelId voxel;
    State state;
  };

  GeodesicCompletion(const LeafIndex& index, PowerMap& map);

  /// Comes before the first round: all voxels that the map does not cover have no site, and may get
  /// one.
  void start(Interrupter* interrupter);
  /// One round: decides for all voxels of the front from the state before it, then writes. Only
  /// voxels beside a change can change in the next round. False if nothing changed.
  bool round(Interrupter* interrupter);
  /// The changes of the last round, in no particular order.
  const std::vector<std::vector<Change>>& changes() const { return changes_; }

  // What follows is for an object that goes on beyond the layers at the ends of the index along z.

  const VoxelSet& uncovered() const { return uncovered_; }
  const VoxelSet& front() const { return front_; }
  /// Goes on where another one was: an uncovered voxel, perhaps of the front.
  void set(const Change& voxel, bool isInFront);
  /// The voxel below (above) one of the index is in that state from now on.
  void setBeyond(VoxelId voxel, bool above, const State& state);

 private:
  std::vector<uint32_t> takeFrontWords();
  void addToFront(VoxelId voxel);
  bool winsTie(const Coord& p, VoxelId a, VoxelId b) const;
  State best(VoxelId p) const;

  const LeafIndex& index_;
  PowerMap& map_;
  VoxelSet uncovered_;
  VoxelSet front_;  // uncovered voxels beside a change of the last round
  // The words of the front that are not empty, and others, so that a round along a thin path does
  // not look through all; absent where they are many.
  std::optional<std::vector<uint32_t>> frontWords_;
  std::vector<std::vector<Change>> changes_;
  std::unordered_map<VoxelId, State> below_, above_;
};

}  // namespace vdb_madf::detail
