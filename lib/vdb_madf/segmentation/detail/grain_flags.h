// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "vdb_madf/leaves/detail/label_masks.h"
#include "vdb_madf/method/tidy.h"
#include "vdb_madf/segmentation/label_flaws.h"

// The parts of labelFlaws(): for labels that are tidied before, or come in several windows.

namespace vdb_madf::detail {

/// tidy(), then labelFlaws() of what it gives: both work on the same masks.
LabelFlaws tidyAndCountFlaws(const LeafIndex& index, int rounds,
                             const std::optional<Domain>& domain, GrainLabels& grains,
                             Interrupter* interrupter);

/// How many pieces, 6-connected, each grain is in: of grain g at g - 1.
std::vector<uint32_t> countPieces(const LeafIndex& index, const LabelMasks& labels, size_t grains,
                                  Interrupter* interrupter);

/// labelFlaws(), where the masks of the labels and countPieces() are known.
LabelFlaws labelFlaws(const LeafIndex& index, const LabelMasks& labels,
                      const std::vector<int64_t>& grainVoxels, const std::vector<uint32_t>& pieces,
                      const std::optional<Domain>& domain, Interrupter* interrupter);

/// What is known of grain g, at g - 1, by the voxels that were looked at.
struct GrainFlags {
  explicit GrainFlags(size_t grains) : deep(grains, 0), touching(grains, 0) {}
  std::vector<char> deep;      ///< has a voxel that is two layers deep
  std::vector<char> touching;  ///< has a voxel beside another grain
};

/// Sets the flags that the voxels of an index show. Whether a grain touches another is looked up if
/// it is not deep, or one of \p small.
void findFlags(const LeafIndex& index, const LabelMasks& labels,
               const std::optional<Domain>& domain, const std::vector<char>& small,
               GrainFlags& flags, Interrupter* interrupter);

/// @param pieces how many each grain is in
LabelFlaws countFlaws(const GrainFlags& flags, const std::vector<int64_t>& grainVoxels,
                      const std::vector<uint32_t>& pieces);

}  // namespace vdb_madf::detail
