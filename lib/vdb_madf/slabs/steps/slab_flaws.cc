// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/slabs/steps/slab_flaws.h"

#include <utility>

namespace vdb_madf::detail {

void SlabFlaws::add(const LeafIndex& index, VoxelArray<uint32_t> labels, Interrupter* interrupter) {
  const int begin = cuts_[slabs_];
  if (slabs_ > 0) {
    lookAtLast(labelsBetween(index, labels, begin, begin + 8), interrupter);
    below_ = labelsBetween(last_.index, last_.labels, begin - 8, begin);
  }
  last_.index = index;
  last_.labels = std::move(labels);
  addPieces(interrupter);
  ++slabs_;
}

/// Of the last slab; a piece goes on beyond a cut under its label.
void SlabFlaws::addPieces(Interrupter* interrupter) {
  const ConnectedComponents components(
      last_.index, LabelMasks(last_.index, last_.labels, interrupter), interrupter);
  const auto face = [&](bool isUpper) {
    return facePieces(last_.index, components, {cuts_[slabs_], cuts_[slabs_ + 1], isUpper});
  };
  pieces_.add(components.count(), pieceJoins(highest_, face(false)));
  highest_ = face(true);
  std::vector<uint32_t> label(components.count());
  for (size_t leaf = 0; leaf < last_.index.leafCount(); ++leaf)
    for (auto piece = components.begin(leaf); piece != components.end(leaf); ++piece)
      label[piece->component] = piece->label;
  labelOf_.push_back(std::move(label));
}

/// Flags need to see one voxel beyond the cuts. What the leaves there show of themselves is true,
/// too.
void SlabFlaws::lookAtLast(const LeafLabels& above, Interrupter* interrupter) {
  const LabelWindow window = labelWindow(last_.index, last_.labels, below_, above);
  const LabelMasks masks(window.index, window.labels, interrupter);
  findFlags(window.index, masks, domain_, all_, flags_, interrupter);
}

LabelFlaws SlabFlaws::finish(const std::vector<int64_t>& grainVoxels, Interrupter* interrupter) {
  if (slabs_ > 0) lookAtLast({}, interrupter);
  std::vector<uint32_t> pieces(grainVoxels.size(), 0);
  std::vector<bool> isCounted(pieces_.size(), false);
  for (size_t s = 0; s < labelOf_.size(); ++s)
    for (uint32_t i = 0; i < labelOf_[s].size(); ++i) {
      const uint32_t whole = pieces_.find(s, i);
      if (isCounted[whole]) continue;
      isCounted[whole] = true;
      ++pieces[labelOf_[s][i] - 1];
    }
  return countFlaws(flags_, grainVoxels, pieces);
}

}  // namespace vdb_madf::detail
