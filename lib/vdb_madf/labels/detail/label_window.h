// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "vdb_madf/labels/detail/label_leaves.h"
#include "vdb_madf/leaves/detail/leaf_neighborhood.h"

namespace vdb_madf::detail {

/// A set of voxels in and around a leaf: -8 to 15 from its origin, the 27 leaves.
struct WindowRows {
  static constexpr int kBegin = -8, kEnd = 16;
  static constexpr int kLine = kEnd - kBegin;  ///< rows of a line

  /// The rows of all y, from kBegin on; bit z + 8 of a row is voxel z.
  const uint32_t* line(int x) const { return rows.data() + size_t((x - kBegin) * kLine); }
  uint32_t* line(int x) { return rows.data() + size_t((x - kBegin) * kLine); }
  uint32_t row(int x, int y) const { return line(x)[y - kBegin]; }

  alignas(64) std::array<uint32_t, size_t{kLine} * kLine> rows;
};

/// The x of a window that are wanted: to leave out the others saves time. By default those that
/// measure/detail/leaf_surface.h draws.
struct WindowRange {
  int begin = -4, end = 14;
};

/// Adds voxels of one of the 27 leaves, `side` as in LeafNeighborhood.
void addLeaf(const LeafIndex::Mask& mask, int side, const WindowRange& range, WindowRows& rows);

/// Which voxels in and around a leaf have a label. One per thread.
class LabelWindow {
 public:
  explicit LabelWindow(const LabelLeaves& labels, const WindowRange& range = {})
      : labels_(&labels), neighborhood_(labels.index()), range_(range) {}

  const WindowRange& range() const { return range_; }

  void moveTo(size_t leaf);

  /// The voxels that have any label, or this one.
  void labelled(WindowRows& rows) const;
  void labelled(int32_t label, WindowRows& rows) const;
  std::vector<int32_t> labels() const;  ///< all, ascending
  /// Takes the voxels of `gone` for those of `kept` from now on, but for label(x, y, z).
  void join(int32_t kept, int32_t gone);
  /// The label of a labeled voxel, -8 to 15 along each axis.
  int32_t label(int x, int y, int z) const;

 private:
  const LabelLeaves* labels_;
  LeafNeighborhood neighborhood_;
  WindowRange range_;
  std::array<uint32_t, 27> around_{};

  /// Where a label lies in one of the 27 leaves.
  struct Place {
    int32_t label;
    int side;
    const LabelPart* part;
  };
  void sortPlaces();

  std::vector<Place> places_;  // all, by label
};

}  // namespace vdb_madf::detail
