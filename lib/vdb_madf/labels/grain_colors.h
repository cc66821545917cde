// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "vdb_madf/base/color.h"
#include "vdb_madf/grids/grid_types.h"
#include "vdb_madf/grids/label_slabs.h"

namespace vdb_madf {

/// A color for each label of a grid, such that touching grains never look alike.
struct GrainColors {
  std::vector<int32_t> labels;  ///< ascending
  std::vector<Rgb> colors;      ///< of labels[i]
  int64_t touchingPairs = 0;    ///< of labels
  /// Touching pairs that had to share a color: 0 unless there is a group of labels of which each
  /// touches 64 others of the group (noise).
  int64_t alikePairs = 0;

  /// Color of a label; gray if the grid does not have it.
  Rgb colorOf(int32_t label) const;
};

/// Colors the graph of touching labels: two labels touch if they have voxels that share a face, an
/// edge or a corner (26-adjacent). Labels are the active voxels of positive value, tiles included.
///
/// Labels in the order of smallest-last (Matula & Beck 1983; tie: smaller label) take, of a palette
/// of 64 colors, the first that no touching label has yet, from a place on that depends on the
/// label. The first 16 colors are at least 26 apart in CIELAB (Euclidean distance, CIE 1976), and
/// at least 15 as those see them who are blind to red, green or blue (protanopia, deuteranopia,
/// tritanopia). They suffice unless there is a group of labels of which each touches 16 others of
/// the group; only then the other 48 serve: all 64 are at least 12 apart, and 5 for these eyes. The
/// colors depend on the grid alone.
/// @throw InvalidInput as LeafIndex does; Interrupted.
GrainColors grainColors(const Int32Grid& labels, Interrupter* interrupter = nullptr);

/// Labels in slabs are read once. @throw as above; what reading throws
GrainColors grainColors(const LabelSlabs& labels, Interrupter* interrupter = nullptr);

/// grainColors() of labels that come in parts, in any order. The neighbors of each voxel of the
/// whole have to be with it in one of the parts.
class GrainColoring {
 public:
  /// @throw as grainColors()
  void add(const Int32Grid& part, Interrupter* interrupter = nullptr);
  void add(const LabelSlabs& parts, Interrupter* interrupter = nullptr);
  GrainColors colors() const;

 private:
  std::vector<int32_t> labels_;                     // ascending
  std::vector<std::pair<int32_t, int32_t>> pairs_;  // that touch, ascending
};

}  // namespace vdb_madf
