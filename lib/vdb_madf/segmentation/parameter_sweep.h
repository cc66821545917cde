// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "vdb_madf/grids/grid_types.h"
#include "vdb_madf/method/boundary.h"
#include "vdb_madf/method/merge.h"
#include "vdb_madf/method/squared_distance.h"
#include "vdb_madf/method/tidy.h"
#include "vdb_madf/segmentation/label_flaws.h"

namespace vdb_madf {

/// Every combination of gamma, mode, delta and theta is a row; of MergeMode::score, which has no
/// delta and theta, every combination of gamma and strictness.
struct SweepOptions {
  std::vector<int64_t> gammas{0};  ///< voxels, 0 or more
  std::vector<MergeMode> modes{MergeMode::score};
  std::vector<double> thetas{-0.9};      ///< cosines in [-1, 1]
  std::vector<int> deltas{2};            ///< eighths of a voxel, see MergeOptions
  std::vector<double> strictnesses{11};  ///< see MergeOptions
  Adjacency adjacency = Adjacency::manifold;
  int64_t minGrain = 0;              ///< as MergeOptions
  int64_t smallVoxels = 100;         ///< a grain of fewer voxels is small
  std::optional<int64_t> fillHoles;  ///< as SegmentOptions
  int tidy = kTidy;                  ///< rounds, as SegmentOptions
  Boundary boundary = Boundary::automatic;
  std::optional<Domain> domain;  ///< overrides the domain in the mask's metadata
  int64_t maxMemory = 0;         ///< bytes that a segmentation may need; 0: no limit
};

/// The grains of one choice of parameters.
struct SweepRow {
  int64_t gamma = 0;
  MergeMode mode = MergeMode::score;
  double theta = 0;
  int delta = 0;
  double strictness = 0;  ///< of MergeMode::score; theta and delta are those of the others
  int64_t grains = 0;
  double medianVoxels = 0;  ///< of the grains' sizes; of an even number the mean of the middle two
  int64_t smallGrains = 0;  ///< of fewer than smallVoxels voxels
  int64_t smallVoxels = 0;  ///< in small grains
  int64_t largestVoxels = 0;  ///< of the largest grain
  int64_t objectVoxels = 0;
  LabelFlaws flaws;
};

/// The grains for each gamma (in the order given), mode, delta and theta, or strictness: the volume
/// is segmented once for each gamma, the manifolds then merged and tidied for each row; rows by
/// score are cut from one hierarchy (hierarchy.h). Each row equals what
/// segment() says with these options; the rows do not depend on threads.
/// @throw InvalidInput if a list is empty, an option is out of range, or as segment(); Interrupted.
std::vector<SweepRow> parameterSweep(const MaskGrid& object, const SweepOptions& options,
                                     Interrupter* interrupter = nullptr);

/// Makes the same rows of stored manifolds (segment() with keepManifold), without distances and
/// power map. Of the options it takes modes, thetas, deltas, strictnesses, adjacency, minGrain,
/// smallVoxels and tidy; the rows repeat the first gamma.
/// @throw InvalidInput also if the grid carries no graph or does not fit it; Interrupted.
std::vector<SweepRow> mergingSweep(const Int32Grid& manifold, const SweepOptions& options,
                                   Interrupter* interrupter = nullptr);

}  // namespace vdb_madf
