// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <vector>

#include "vdb_madf/base/detail/disjoint_sets.h"
#include "vdb_madf/slabs/cuts/slab_pieces.h"
#include "vdb_madf/slabs/segment_slabs.h"

namespace vdb_madf::detail {

/// A slab of the object with its cavities filled.
struct SlabBody {
  LeafIndex index;
  std::vector<VoxelId> cavities;  ///< voxels that are none of the object, ascending

  SlabBody() = default;
  SlabBody(std::vector<LeafIndex::LeafVoxels> object,
           const std::vector<LeafIndex::LeafVoxels>& holes);
};

/// The voxels in a slab of the cavities of fewer than `fillHoles` voxels. These reach less than
/// that beyond its cuts, so it is enough to look that far: what lies in the slab and reaches
/// further is no cavity.
std::vector<LeafIndex::LeafVoxels> slabHoles(const SlabObject& object, std::optional<Domain> domain,
                                             size_t slab, bool open, int64_t fillHoles,
                                             Interrupter* interrupter);

/// Counts cavities, which may lie in several slabs.
class HoleCount {
 public:
  /// Adds the holes of the next slab, from the lowest on.
  void add(const std::vector<LeafIndex::LeafVoxels>& holes, int begin, int end);
  int64_t voxels() const { return voxels_; }
  int64_t count() const { return pieces_.count(); }
  const CoordBBox& boundingBox() const { return boundingBox_; }

 private:
  int64_t voxels_ = 0;
  CoordBBox boundingBox_;
  PieceUnion pieces_;
  std::vector<FacePiece> highest_;  // of the slab before
};

}  // namespace vdb_madf::detail
