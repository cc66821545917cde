// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include "vdb_madf/grid_types.h"

namespace vdb_madf {

using ColorGrid = openvdb::Grid<StandardTree<openvdb::Vec3f>>;  ///< = openvdb::Vec3SGrid

// Label grids made smaller by a whole factor: coarse voxel (i,j,k) stands for the fine voxels
// factor * i .. factor * i + factor - 1 along each axis, and its centre lies at their centre in the
// world. Domain and voxel size follow; provenance is carried over. Labels are the active voxels
// (tiles included) of positive value. Factor 1 changes nothing but the topology: no tiles.

constexpr int kLargestReduction = 256;

/// The smallest factor that makes a box at most `maxDim` voxels long.
/// @throw InvalidInput if that exceeds kLargestReduction, or maxDim < 1.
int reductionFor(const CoordBBox& box, int maxDim);

/// Each coarse voxel takes the most frequent value of its fine ones, background (0) included; of
/// equally frequent ones the smallest. Labels are never averaged.
/// @throw InvalidInput if the factor is not 1 .. kLargestReduction; Interrupted.
Int32Grid::Ptr reduceLabels(const Int32Grid& labels, int factor,
                            Interrupter* interrupter = nullptr);

/// What renderers show: fog and colours on the same voxels.
struct LabelPreview {
  FloatGrid::Ptr density;  ///< fog volume: the labelled part of each coarse voxel, (0, 1]
  /// Linear RGB (of the sRGB of grain_colors.h) of the most frequent label, background left out; of
  /// equally frequent ones the smallest. Not a vector to be turned: VEC_INVARIANT.
  ColorGrid::Ptr color;
};
/// Colours are those of the full resolution. @throw as reduceLabels.
LabelPreview previewLabels(const Int32Grid& labels, int factor, Interrupter* interrupter = nullptr);

}  // namespace vdb_madf
