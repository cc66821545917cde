// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstdint>
#include <unordered_map>
#include <vector>

#include "vdb_madf/grids/domain.h"
#include "vdb_madf/labels/detail/label_leaves.h"
#include "vdb_madf/method/voxel_weights.h"

namespace vdb_madf::detail {

/// The set-Voronoi cells of grains (Schaller et al. 2013) whose voxels may come in slabs, lowest
/// first: the voxels of the domain to which no labeled voxel is nearer than one of the grain;
/// between grains at the same distance the smaller label has it. Exact integers.
///
/// The least (squared distance, label) is separable: along z by the runs of labels in a column,
/// along y and x as the lower envelope of parabolas (Meijster et al. 2000). Slices are independent.
/// Memory: 24 bytes for each column of the domain's box along z, 12 for each run of a label in one,
/// and per thread some slices. Time: that of the domain's box.
class VoronoiCells {
 public:
  /// @param transform of the labels, which tells the edges of voxels
  /// @throw InvalidInput if squared distances in the domain could exceed 31 bits, or no weights fit
  ///   the voxels (voxel_weights.h)
  VoronoiCells(const Domain& domain, const openvdb::math::Transform& transform);

  void add(const LabelLeaves& slab);

  struct Cell {
    int64_t voxels = 0;
    bool atDomainFace = false;  ///< a voxel of it has a face neighbor outside the domain
    int neighbors = 0;          ///< grains whose cells share a voxel face with it
  };
  /// The cells by label. @throw Interrupted
  std::unordered_map<int32_t, Cell> cells(Interrupter* interrupter) const;

  /// The labels of the cells in a slice of the domain's box, by x, then y; the lowest is slice 0.
  /// 0: outside of the domain, or no voxel is labeled.
  using Slice = std::vector<int32_t>;
  Slice slice(int z) const;

 private:
  struct Run {
    int begin, end;
    int32_t label;
  };
  struct Part;
  int64_t nearestInColumn(const std::vector<Run>& runs, int z) const;
  std::vector<char> inside(int z) const;
  void count(int begin, int end, Part& part) const;

  Domain domain_;
  VoxelWeights weights_;
  Coord min_, dim_;                        // of the domain's box
  std::vector<std::vector<Run>> columns_;  // by x, then y
};

}  // namespace vdb_madf::detail
