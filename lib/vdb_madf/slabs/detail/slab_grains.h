// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstdint>
#include <vector>

#include "vdb_madf/slabs/detail/slab_graph.h"
#include "vdb_madf/slabs/detail/slab_work.h"

namespace vdb_madf::detail {

/// The grains of an object in slabs.
class SlabGrains {
 public:
  /// Merges where the terminals of all slabs lead to, one slab after the other. Reads the pieces
  /// "terminals", leaves the pieces "classes".
  /// @param graph all is answered
  SlabGrains(SlabWork& work, SlabGraph graph, const VoxelWeights& weights);

  /// Of grain g at g - 1.
  const std::vector<Coord>& representatives() const { return grains_.representative; }
  /// The grain of each terminal of a slab; 0: none of the object.
  std::vector<uint32_t> grainsOf(size_t slab) const;

 private:
  SlabTerminals terminals(size_t slab) const;

  SlabWork& work_;
  PartGrains grains_;
};

}  // namespace vdb_madf::detail
