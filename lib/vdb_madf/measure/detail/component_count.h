// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "vdb_madf/leaves/detail/connected_components.h"
#include "vdb_madf/leaves/detail/leaf_layers.h"

namespace vdb_madf::detail {

/// Counts the 6-connected components of an object that comes in slabs, from the lowest on. Memory:
/// per column of the highest layer, besides what the components of a slab take.
class ComponentCount {
 public:
  /// \p slab: the leaves in these layers, above those before. @throw Interrupted
  void add(const LeafIndex& slab, const LeafLayers& layers, Interrupter* interrupter);
  int64_t count() const { return count_; }

 private:
  /// A leaf below the cut.
  struct Top {
    Coord origin;
    std::array<uint32_t, 64> classes;  ///< of the voxels of its highest layer, by x*8 + y
  };

  int64_t count_ = 0;
  std::vector<Top> tops_;  // by origin
  uint32_t classes_ = 0;   // of the voxels below the cut: what is connected so far
};

}  // namespace vdb_madf::detail
