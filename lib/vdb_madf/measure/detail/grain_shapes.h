// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <vector>

#include "vdb_madf/labels/detail/label_leaves.h"
#include "vdb_madf/measure/detail/voxel_shape.h"
#include "vdb_madf/measure/grain_shape.h"

namespace vdb_madf::detail {

/// The shapes of grains whose voxels may come in slabs. Memory: 16 bytes for each label of a leaf
/// of a slab, for each thread the ends of the rows of voxels of a grain, and these for each grain
/// that goes on beyond a slab.
class GrainShapes {
 public:
  explicit GrainShapes(const VoxelShape& voxel) : voxel_(voxel) {}

  /// \p isComplete: of a label, whether none of its voxels are in slabs to come. @throw Interrupted
  void add(const LabelLeaves& slab, const std::function<bool(int32_t label)>& isComplete,
           Interrupter* interrupter);
  /// The shapes of the labels that are complete.
  const std::map<int32_t, GrainShape>& shapes() const { return shapes_; }

  /// A row of voxels along z, from the first to the last; what lies between has no part in the
  /// hull.
  struct Row {
    int x, y, first, last;
  };

 private:
  VoxelShape voxel_;
  std::map<int32_t, std::vector<Row>> open_;
  std::map<int32_t, GrainShape> shapes_;
};

}  // namespace vdb_madf::detail
