// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "vdb_madf/grids/domain.h"
#include "vdb_madf/labels/detail/label_leaves.h"
#include "vdb_madf/measure/detail/leaf_surface.h"

namespace vdb_madf::detail {

/// Integer sums over the voxels of a grain: exact, so independent of the order of summation.
struct GrainSums {
  int32_t label = 0;
  int64_t voxels = 0;
  std::array<int64_t, 3> sum{};       ///< of coordinates relative to LabelSums::origin
  std::array<int64_t, 6> products{};  ///< likewise: xx, yy, zz, xy, xz, yz
  CoordBBox box;
  int64_t freeArea = 0;               ///< in kAreaUnit
  std::array<int64_t, 3> cutFaces{};  ///< across each axis
  bool atRegionWall = false;  ///< the domain is a region, and a face neighbor lies outside of it
};

/// Two grains with at least one voxel face in common.
struct BondSums {
  int32_t first = 0, second = 0;  ///< labels, first < second
  std::array<int64_t, 3> areas{};
  std::vector<InterfaceFace> faces;  ///< by lower voxel, then axis
};

struct LabelSums {
  Coord origin;
  std::vector<GrainSums> grains;  ///< by label
  std::vector<BondSums> bonds;    ///< by first, then second label
};

/// All that grains and bonds are measured from, in one pass over the leaves. Memory: per grain,
/// per bond and per face of a bond, for each thread. `open`: what lies outside the domain is no
/// background but unknown.
LabelSums labelSums(const LabelLeaves& labels, const Domain& domain, bool open,
                    const VoxelShape& voxel, Interrupter* interrupter);

}  // namespace vdb_madf::detail
