// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include "vdb_madf/grids/label_slabs.h"

namespace vdb_madf::detail {

/// Goes through slabs of labels from the lowest on. Each has the leaves with it that lie beside it,
/// beyond its cuts; the next slab is in memory, too.
class RimmedSlabs {
 public:
  explicit RimmedSlabs(const LabelSlabs& slabs) : slabs_(slabs) {}

  /// Goes on to the next one; false after the last. @throw Interrupted; what reading throws
  bool next(Interrupter* interrupter);

  /// Labels of the slab, and those beside it; no tiles.
  const Int32Grid& labels() const { return *slab_; }
  /// Does a leaf lie in the slab itself?
  bool isOwn(const Coord& origin) const {
    return origin.z() >= slabs_.cuts[at_] && origin.z() < slabs_.cuts[at_ + 1];
  }

 private:
  Int32Grid::Ptr read(size_t slab, Interrupter* interrupter) const;

  const LabelSlabs& slabs_;
  size_t at_ = 0;
  Int32Grid::Ptr slab_, above_;  // that one, with the leaves beside it, and the next, without
};

}  // namespace vdb_madf::detail
