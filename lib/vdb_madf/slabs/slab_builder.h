// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "vdb_madf/slabs/segment_slabs.h"

namespace vdb_madf {

/// Where an object is cut.
struct SlabLimits {
  int64_t bytes = 0;    ///< SlabCosts of a slab, unless one layer of leaf nodes has more; 0: any
  int height = 0;       ///< of a slab, voxels, rounded up to a multiple of 8; 0: any
  int leastHeight = 8;  ///< of a slab, but for the last
};

/// The memory that segmentSlabs() takes at its peak, about, in bytes, as `tests/memory` finds. For
/// limits.
struct SlabCosts {
  int64_t leaf;   ///< of each leaf node of a slab: mostly that of the grid of labels
  int64_t voxel;  ///< of each of its voxels: maps, and what of them goes to scratch
  /// Each of its voxels that may become a critical point, about (detail/leaf_mask.h), adds this:
  /// the graph, or what the filter leaves without a ball.
  int64_t thin = 560;
  int64_t speck;  ///< of each grain of the whole that is in one piece within a leaf node

  explicit SlabCosts(const SegmentOptions& options);
  int64_t of(int64_t leaves, int64_t voxels, int64_t thinVoxels) const {
    return leaf * leaves + voxel * voxels + thin * thinVoxels;
  }
};
/// Apart from that: the program itself.
constexpr int64_t kSlabOtherBytes = int64_t(92) << 20;

/// What some leaf nodes cost.
struct LeafCosts {
  int64_t ofSlab = 0;   ///< while their slab is worked on
  int64_t ofWhole = 0;  ///< all the time
};

/// Adds the leaves of a layer that hold object voxels; returns what they cost.
/// @throw InvalidInput if the layer has active tiles
LeafCosts addLeaves(const MaskTree& layer, const SlabCosts& costs,
                    std::vector<LeafIndex::LeafVoxels>& leaves);

/// Cuts an object that comes in layers of leaf nodes into slabs, and keeps these in scratch.
class SlabBuilder {
 public:
  SlabBuilder(const SlabLimits& limits, const SlabCosts& costs, Scratch& scratch)
      : limits_(limits), costs_(costs), scratch_(scratch) {}

  /// The next layer, which lies above those before. @throw InvalidInput if it does not
  void add(const MaskTree& layer);
  /// Comes after the last layer. The slabs cover the domain, if there is one, and the object.
  void finish(const std::optional<Domain>& domain);

  size_t slabCount() const { return cuts_.size() - 1; }  ///< once it is finished
  /// What the largest slab and the whole take.
  int64_t bytes() const { return largestSlabBytes_ + wholeBytes_; }

 private:
  void endSlab(int z);

  SlabLimits limits_;
  SlabCosts costs_;
  Scratch& scratch_;
  std::vector<int> cuts_;
  std::vector<LeafIndex::LeafVoxels> leaves_;  // of the slab that is not ended
  int64_t bytes_ = 0;                          // of the same
  int64_t largestSlabBytes_ = 0;
  int64_t wholeBytes_ = 0;
  std::optional<int> lastLayer_;
};

/// Says that the slabs of an object are whole in this scratch, and where it is cut.
void writeCuts(Scratch& scratch, const std::vector<int>& cuts);

/// Have the slabs of an object been finished in this scratch?
bool hasSlabs(const Scratch& scratch);

/// The object that was cut there. @param about see SlabObject; scratch must outlive the result
SlabObject storedSlabs(const Scratch& scratch, MaskGrid::ConstPtr about);

}  // namespace vdb_madf
