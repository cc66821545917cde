// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include "vdb_madf/grids/grid_types.h"
#include "vdb_madf/grids/label_slabs.h"

namespace vdb_madf {

using ColorGrid = openvdb::Grid<StandardTree<openvdb::Vec3f>>;  ///< = openvdb::Vec3SGrid

/// What renderers show: fog and colors on the same voxels.
struct LabelPreview {
  FloatGrid::Ptr density;  ///< fog volume: the labeled part of each coarse voxel, (0, 1]
  /// Linear RGB (of the sRGB of grain_colors.h) of the most frequent label, background left out; of
  /// equally frequent ones the smallest. Not a vector to be turned: VEC_INVARIANT.
  ColorGrid::Ptr color;
};
/// Colors are those of the full resolution. Factor: as reduceLabels() (labels/reduced_labels.h),
/// also what it throws.
LabelPreview previewLabels(const Int32Grid& labels, int factor, Interrupter* interrupter = nullptr);

/// Labels in slabs are read twice. @throw as above; what reading throws
LabelPreview previewLabels(const LabelSlabs& labels, int factor,
                           Interrupter* interrupter = nullptr);

}  // namespace vdb_madf
