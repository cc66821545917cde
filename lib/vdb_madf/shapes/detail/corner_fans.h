// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <algorithm>
#include <array>
#include <cstdint>

#include "vdb_madf/labels/detail/label_blocks.h"

namespace vdb_madf::detail {

// The eight voxels around a corner: number dx*4 + dy*2 + dz, d = 0 below the corner, 1 above. The
// twelve faces between them: axis*4 + du*2 + dv, where u and v are the axes after `axis`, cyclic.

/// Says for every set of voxels around a corner (bit n: voxel n belongs to the grain) which of the
/// faces of the set around the corner hang together in one fan.
struct Fans {
  std::array<uint8_t, 256> count{};
  std::array<std::array<uint8_t, 12>, 256> fan{};  ///< of a face; 0xff: it is no face of the set
};

const Fans& fans();

/// The grains that meet at a corner, ascending, each with its voxels.
struct Corner {
  int grains = 0, labels = 0;  ///< labels: with the background; none where there is one label
  std::array<int32_t, 8> label{};
  std::array<uint8_t, 8> set{};
  int pointCount = 0;

  Corner() = default;
  /// \p at: the halo's value at the voxel above the corner.
  explicit Corner(const int32_t* at) {
    std::array<int32_t, 8> voxel;
    for (int n = 0; n < 8; ++n) {
      int back = 0;
      for (int axis = 0; axis < 3; ++axis)
        if (!(n >> (2 - axis) & 1)) back += kHaloStride[axis];
      voxel[size_t(n)] = at[-back];
    }
    if (std::all_of(voxel.begin(), voxel.end(), [&](int32_t v) { return v == voxel[0]; })) return;
    setVoxels(voxel);
  }

  /// Place among the corner's points of the one that a grain's face uses.
  uint32_t point(int32_t grain, int face) const;

 private:
  void setVoxels(const std::array<int32_t, 8>& voxel);
};

}  // namespace vdb_madf::detail
