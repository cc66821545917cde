// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <utility>
#include <vector>

#include "vdb_madf/grids/domain.h"
#include "vdb_madf/labels/detail/label_leaves.h"
#include "vdb_madf/measure/detail/leaf_surface.h"

namespace vdb_madf::detail {

/// Integer sums over the voxels of a grain: exact, so independent of the order of summation.
struct GrainSums {
  int32_t label = 0;
  int64_t voxels = 0;
  std::array<int64_t, 3> sum{};       ///< of coordinates relative to LabelSums::origin()
  std::array<int64_t, 6> products{};  ///< likewise: xx, yy, zz, xy, xz, yz
  CoordBBox box;
  int64_t freeArea = 0;  ///< in kAreaUnit
  /// Faces by side, in no order; relative to LabelSums::origin().
  std::vector<LeafSurface::CutFaces> cuts;
  bool atRegionWall = false;  ///< the domain is a region, and a face neighbor lies outside of it
};

/// Two grains with at least one voxel face in common.
struct BondSums {
  int32_t first = 0, second = 0;  ///< labels, first < second
  std::array<int64_t, 3> areas{};
  std::vector<InterfaceFace> faces;  ///< by lower voxel, then axis
};

/// All that grains and bonds are measured from, in one pass over the leaves. These may come slab by
/// slab: the sums are those of the whole. Memory: per grain, per bond and per face of a bond that
/// was not taken, for each thread.
class LabelSums {
 public:
  /// Grains are summed from `origin`. `open`: what lies outside the domain is no background but
  /// unknown.
  LabelSums(const Coord& origin, const Domain& domain, bool open, const VoxelShape& voxel);

  /// The leaves in some layers. Those around them have to be there, too. @throw Interrupted
  void add(const LabelLeaves& labels, const LeafLayers& layers, Interrupter* interrupter);

  const Coord& origin() const { return origin_; }
  std::vector<GrainSums> grains() const;  ///< by label
  /// Takes away the bonds of which nothing more comes; by first, then second label. @throw
  /// Interrupted
  std::vector<BondSums> takeBonds(
      const std::function<bool(int32_t first, int32_t second)>& isComplete,
      Interrupter* interrupter);

 private:
  Coord origin_;
  Domain domain_;
  bool open_;
  VoxelShape voxel_;
  std::map<int32_t, GrainSums> grains_;
  std::map<std::pair<int32_t, int32_t>, BondSums> bonds_;
};

}  // namespace vdb_madf::detail
