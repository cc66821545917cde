// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "vdb_madf/base/interrupter.h"
#include "vdb_madf/grids/domain.h"
#include "vdb_madf/grids/grid_types.h"

namespace vdb_madf::detail {

/// Labels and object at 1/factor, as writeOmeZarr() defines them; no tiles.
struct CoarseTrees {
  Int32Tree label;  ///< the most frequent ones
  Int32Tree gray;   ///< parts of the voxels, times 255
};
/// @throw InvalidInput if the factor is not 1 .. kMaxReduction; Interrupted
CoarseTrees coarseTrees(const Int32Grid& labels, int factor, const std::optional<Domain>& domain,
                        Interrupter* interrupter);

/// How many voxels of a leaf have a label.
struct LabelCount {
  Coord leaf;  ///< its origin
  int32_t label = 0;
  int64_t voxels = 0;
};
/// Counts the labels of all leaves of a tree without active tiles. @throw Interrupted
std::vector<LabelCount> countLabels(const Int32Tree& labels, Interrupter* interrupter);

/// coarseTrees() of labels that come in layers of leaves from below, for a multiple of 8 as factor:
/// what is known of the coarse voxels that are not complete.
class CoarseCounts {
 public:
  CoarseCounts(int factor, std::optional<Domain> domain)
      : factor_(factor), domain_(std::move(domain)) {}

  void add(const std::vector<LabelCount>& counts);
  /// Takes the coarse voxels below a coarse slice, of which all leaves were added.
  CoarseTrees take(int end);

 private:
  /// The count of a coarse voxel, whose place stands for the leaf.
  using Entry = LabelCount;
  static bool comesBefore(const Entry& a, const Entry& b);

  int factor_;
  std::optional<Domain> domain_;
  std::vector<Entry> entries_;  // by z, y, x, then label; each once
};

}  // namespace vdb_madf::detail
