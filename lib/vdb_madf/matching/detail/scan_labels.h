// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <functional>
#include <map>

#include "vdb_madf/grids/label_slabs.h"

namespace vdb_madf::detail {

/// Labels of a scan in memory, or in slabs, of which some layers are looked at at a time.
class ScanLabels {
 public:
  /// Some layers of leaves, without tiles.
  struct Part {
    Int32Tree::ConstPtr tree;
    int low, high;  ///< its own are those of low <= z < high; there may be others beside them

    bool isOwn(const Coord& leaf) const { return leaf.z() >= low && leaf.z() < high; }
  };

  explicit ScanLabels(const Int32Grid& labels);
  /// The labels must live as long.
  explicit ScanLabels(const AnyLabels& labels);

  bool isWhole() const { return whole_ != nullptr; }  ///< all layers are in memory
  /// Lets f see all layers, each as an own one once, with those that are at most `margin` voxels
  /// from them. @throw Interrupted; what reading throws
  void forEachPart(int margin, Interrupter* interrupter, const std::function<void(const Part&)>& f);
  /// The layers of leaves with low <= z <= high, at least. Slabs of no such layer are forgotten,
  /// and read again if need be. @throw as forEachPart()
  Int32Tree::ConstPtr layers(int low, int high, Interrupter* interrupter);

 private:
  Int32Tree::ConstPtr whole_;
  const LabelSlabs* slabs_ = nullptr;
  std::map<size_t, Int32Tree::ConstPtr> read_;
};

}  // namespace vdb_madf::detail
