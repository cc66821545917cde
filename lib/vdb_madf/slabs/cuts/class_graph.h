// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstdint>
#include <tuple>
#include <vector>

#include "vdb_madf/slabs/cuts/slab_part.h"

namespace vdb_madf::detail {

/// What a slab adds to the graph of the classes that a hierarchy begins with (hierarchy.h), or of
/// those of the tests, of which small ones join others (join_small.h). Classes are numbered from 0,
/// in the order of their representatives.
struct ClassGraph {
  struct Size {
    uint32_t number;
    int32_t top, sure;  ///< the largest D that the slab knows of, and the largest sure one
    int64_t voxels, cavityVoxels;
  };
  std::vector<Size> sizes;                    ///< ascending, each class once
  std::vector<ManifoldGraph::Edge> contacts;  ///< ascending, each pair once

  template <typename Self>
  static auto storedFields(Self& self) {
    return std::tie(self.sizes, self.contacts);
  }
};

/// @param classOfNode of each node of the part
ClassGraph classGraph(const SlabPart& part, const std::vector<uint32_t>& classOfNode);

/// The graph of all classes: merge() by score makes of it what it makes of the graph of the
/// manifolds, as no edge that is left joins a class at the tests that it begins with. (Tops grow,
/// and each edge was lower than both when it was visited.)
class JoinedClasses {
 public:
  explicit JoinedClasses(const std::vector<Coord>& representatives);
  void add(const ClassGraph& part);
  ManifoldGraph finish(const VoxelWeights& weights, const std::optional<int>& flatAxis);

 private:
  ManifoldGraph graph_;
};

}  // namespace vdb_madf::detail
