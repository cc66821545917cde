// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include "vdb_madf/slabs/steps/slab_map.h"

namespace vdb_madf::detail {

/// GeodesicCompletion (method/detail) in slabs.
///
/// What a voxel is after a round depends on itself and its neighbors after the round before. A slab
/// plays a window of rounds, with what it knows of the changes beyond its cuts in that window, and
/// tells its own ones there. If it learns of others, it plays the window again. When none does, all
/// is as in common rounds: by induction over the rounds, for the first wrong change would have a
/// cause before it. Each time one round more at least is right, so a window of n rounds is played n
/// times at most. Windows double; the last one ends with no voxel that may still change.
class SlabCompletion {
 public:
  explicit SlabCompletion(SlabWork& work) : work_(work) {}

  /// Puts the map of an own slab, of the kept balls, into scratch.
  void begin(size_t slab, LeafIndex& index, PowerMap& map, Interrupter* interrupter);
  /// When all slabs have begun.
  void run();
  /// The completed map of a slab, afterwards.
  PowerMap completed(size_t slab, LeafIndex& index) const;
  /// The map is not needed any more.
  void forget(size_t slab);

 private:
  int firstWindow() const;
  bool play(size_t slab);
  void forgetWindow(size_t slab);

  SlabWork& work_;
  int window_ = 0;  // what is there is the state before it
};

}  // namespace vdb_madf::detail
