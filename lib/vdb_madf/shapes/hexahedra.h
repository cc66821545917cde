// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "vdb_madf/grids/grid_types.h"
#include "vdb_madf/leaves/leaf_index.h"

namespace vdb_madf {

/// One element per voxel: more are some gigabytes of text, and more than solvers take.
constexpr size_t kMaxHexahedra = 20000000;

/// The size of a file of hexahedra.
struct HexahedraCounts {
  size_t grains = 0, elements = 0, nodes = 0;
};

/// Every labeled voxel (active, tiles included, > 0) as a hexahedron: elements and the nodes at
/// their corners, the voxel's center +- half a voxel.
///
/// Voxels that share a corner share the node, those of other grains too: bonds are perfect, and
/// voxels that touch along an edge or at a corner only are hinged there. Elements are ordered by
/// label, then by place, nodes by place: the same for any number of threads.
/// Memory: some 20 bytes per voxel.
class Hexahedra {
 public:
  /// @throw InvalidInput for voxels that are not along the axes, more than kMaxHexahedra
  ///   voxels or a limit of leaf_index.h; Interrupted.
  explicit Hexahedra(const Int32Grid& labels, Interrupter* interrupter = nullptr);

  const HexahedraCounts& counts() const { return counts_; }
  int32_t label(size_t element) const { return int32_t(elements_[element] >> 32); }
  /// Is the element the first one of its grain?
  bool isFirst(size_t element) const {
    return element == 0 || label(element) != label(element - 1);
  }
  /// Numbers of the nodes, in the order that VTK and Abaqus share: around the lower face
  /// counterclockwise seen from above, then the upper one.
  std::array<uint32_t, 8> nodes(size_t element) const;
  /// f(place) for all nodes, in order; world.
  void forEachNode(const std::function<void(const openvdb::Vec3d&)>& f) const;

 private:
  std::array<uint32_t, 8> leavesFrom(uint32_t leaf) const;

  openvdb::Vec3d origin_;  // of the world
  openvdb::Vec3d edges_{1, 1, 1};
  LeafIndex corners_;
  std::vector<std::array<uint32_t, 8>> around_;  // leaves of corners_ of each leaf of voxels
  std::vector<uint64_t> elements_;               // label, then VoxelId
  HexahedraCounts counts_;
};

}  // namespace vdb_madf
