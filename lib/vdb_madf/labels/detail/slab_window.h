// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <map>

#include "vdb_madf/grids/label_slabs.h"
#include "vdb_madf/labels/detail/label_leaves.h"

namespace vdb_madf::detail {

/// A window that moves up through slabs: those below it are forgotten, and read again if need be.
/// What it holds takes a tenth of the memory of a grid.
class SlabWindow {
 public:
  explicit SlabWindow(const LabelSlabs& slabs) : slabs_(&slabs) {}

  /// The leaves in some layers.
  /// @throw InvalidInput if a slab has labels outside of its cuts; Interrupted; what reading
  /// throws.
  LabelLeaves leaves(const LeafLayers& layers, Interrupter* interrupter);

 private:
  const LabelSlabs* slabs_;
  std::map<size_t, LabelLeaves> read_;
};

}  // namespace vdb_madf::detail
