// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "vdb_madf/segmentation/detail/grain_flags.h"
#include "vdb_madf/slabs/cuts/slab_pieces.h"

namespace vdb_madf::detail {

/// labelFlaws() of labels in slabs. A slab is kept until the next one comes.
class SlabFlaws {
 public:
  SlabFlaws(size_t grains, std::vector<int> cuts, std::optional<Domain> domain)
      : cuts_(std::move(cuts)), domain_(std::move(domain)), flags_(grains), all_(grains, 1) {}

  /// The labels of the next slab, from the lowest on. @throw Interrupted
  void add(const LeafIndex& index, VoxelArray<uint32_t> labels, Interrupter* interrupter);
  /// Counts the flaws, after the last slab.
  LabelFlaws finish(const std::vector<int64_t>& grainVoxels, Interrupter* interrupter);

 private:
  void addPieces(Interrupter* interrupter);
  void lookAtLast(const LeafLabels& above, Interrupter* interrupter);

  std::vector<int> cuts_;
  std::optional<Domain> domain_;
  GrainFlags flags_;
  std::vector<char> all_;

  size_t slabs_ = 0;  // that were added
  LabelWindow last_;
  LeafLabels below_;                // the highest leaves of the slab below the last one
  std::vector<FacePiece> highest_;  // of the last one
  PieceUnion pieces_;
  std::vector<std::vector<uint32_t>> labelOf_;  // of each piece of each slab
};

}  // namespace vdb_madf::detail
