// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "vdb_madf/base/voxel_size.h"
#include "vdb_madf/samples/sample.h"

namespace vdb_madf {

/// Balls of real radius uniform in [minRadius, maxRadius] at uniform real centers, Boolean union,
/// cropped at the faces, until the solid fraction is met within 0.5 % absolute. No truth. Centers
/// lie in the box grown by maxRadius, so that the faces see as many balls as the middle; at the
/// end, a ball that would exceed the fraction is left out. Works leaf by leaf: no dense array at
/// any size; full leaves are active tiles. The fraction is that of the sample's own voxels: if
/// these are no cubes, the balls are not quite those of cubes.
struct PackOptions {
  Coord size{256, 256, 256};
  uint64_t seed = 1;
  double fraction = 0.25;  ///< above 0, below 1
  double minRadius = 8, maxRadius = 28;
  std::optional<VoxelSize> voxelSize;  ///< need not be cubes: see sample.h
};
Sample generatePack(const PackOptions& options, Interrupter* interrupter = nullptr);

namespace detail {
class BallSlabs;
}

/// The same object in slabs along z, bit for bit, which need not fit in memory together: its balls
/// are kept, and drawn where they are asked for. The size may be 1,048,576 along z. Finding the
/// balls takes some ten times as long as drawing all slabs once.
class PackSlabs {
 public:
  /// @throw as generatePack()
  explicit PackSlabs(const PackOptions& options, Interrupter* interrupter = nullptr);

  /// Slab s is cuts()[s] <= z < cuts()[s + 1]: 128 voxels high, but for the last.
  const std::vector<int>& cuts() const { return cuts_; }
  size_t slabCount() const { return cuts_.size() - 1; }
  int64_t objectVoxels() const;
  /// Sample::object within a slab. @throw Interrupted
  MaskGrid::Ptr object(size_t slab, Interrupter* interrupter = nullptr) const;

 private:
  PackOptions options_;
  Coord voxels_;
  std::vector<int> cuts_;
  std::shared_ptr<const detail::BallSlabs> balls_;
};

}  // namespace vdb_madf
