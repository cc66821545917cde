// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <optional>
#include <string>
#include <vector>

#include "vdb_madf/grids/grid_types.h"
#include "vdb_madf/method/boundary.h"
#include "vdb_madf/method/manifold_graph.h"
#include "vdb_madf/method/merge.h"
#include "vdb_madf/method/squared_distance.h"
#include "vdb_madf/method/stable_strictness.h"
#include "vdb_madf/method/tidy.h"
#include "vdb_madf/method/voxel_weights.h"
#include "vdb_madf/segmentation/label_flaws.h"

namespace vdb_madf {

/// What decides the labels.
struct SegmentOptions {
  /// Smallest cell of a medial ball that is kept, in voxels; 0 and 1: no filter.
  int64_t gamma = 0;
  Boundary boundary = Boundary::automatic;  ///< see boundary.h
  std::optional<Domain> domain;             ///< overrides the domain in the mask's metadata
  /// Overrides the weights that the edges in the mask's transform give (voxel_weights.h).
  std::optional<VoxelWeights> weights;
  MergeOptions merge;
  /// Takes the strictness of largest stability (stable_strictness.h) in place of merge.strictness;
  /// not in slabs.
  bool autoStrictness = false;
  /// Cavities of fewer voxels are filled while the method runs (cavities.h); 0: none; absent:
  /// defaultFillHoles().
  std::optional<int64_t> fillHoles;
  int tidy = kTidy;  ///< rounds of smoothing the interfaces (tidy.h); 0: labels as merged
  /// Return distanceSquared; 4 bytes more per leaf voxel.
  bool keepDistance = false;
  bool keepPower = false;     ///< return power
  bool keepManifold = false;  ///< return manifold
  bool keepBalls = false;     ///< return balls
  /// Refuse what needs more memory than this, bytes (segment_memory.h); 0: no limit.
  int64_t maxMemory = 0;
};

/// Balls and critical points are those of the body, cavities filled; voxels, leaves and grains
/// those of the object.
struct SegmentCounts {
  int64_t objectVoxels = 0;
  int64_t cavities = 0;        ///< that were filled
  int64_t cavityVoxels = 0;    ///< in them
  int64_t medialBalls = 0;     ///< of the unfiltered power map
  int64_t keptBalls = 0;       ///< after the filter; = medialBalls without one
  int64_t criticalPoints = 0;  ///< fixed points of the (filtered) power map
  int64_t grains = 0;
  int64_t largestSquaredDistance = 0;
  int64_t leaves = 0;  ///< touched 8x8x8 leaf nodes
};

/// A ball of the reduced medial axis of the unfiltered power map.
struct MedialBall {
  Coord center;
  int32_t squaredRadius = 0;  ///< D(center)
  int64_t cellSize = 0;       ///< voxels that map to it
};

/// What a stage took.
struct StageTime {
  std::string stage;  ///< snake_case
  double seconds = 0;
  int64_t peakBytes = 0;   ///< largest resident memory of the process until the stage's end
  int64_t pageFaults = 0;  ///< pages that the process touched for the first time
};

/// What a run says of itself, in memory or in slabs; with the options this is what grids tell of
/// it.
struct SegmentationRecord {
  SegmentCounts counts;
  std::optional<Domain> domain;
  bool open = false;      ///< the boundary that was used
  int64_t fillHoles = 0;  ///< the number that was used
  int tidy = 0;           ///< rounds
  /// The weights that were used: all squared lengths of the run are in their units, voxels squared
  /// for 1:1:1.
  VoxelWeights weights;
  double weightsError = 0;  ///< of squared lengths, relative (WeightsOfEdges)
};

/// The grains, what was kept on the way to them, and how they came about.
struct Segmentation : SegmentationRecord {
  Int32Grid::Ptr grain;                    ///< labels 1..N on X; background 0, inactive
  Int32Grid::Ptr distanceSquared;          ///< D, if kept; of the body, on X
  Int32Grid::Ptr power;                    ///< pi' = least power, if kept
  Int32Grid::Ptr manifold;                 ///< critical points 1..K, if kept
  std::vector<MedialBall> balls;           ///< lexicographic centers, if kept; some in cavities
  ManifoldGraph graph;                     ///< node i is critical point i + 1; voxels: those of X
  std::vector<int64_t> grainVoxels;        ///< voxels of grain g at g - 1
  LabelFlaws flaws;                        ///< of the final labels
  std::optional<StableStrictness> stable;  ///< with autoStrictness: the strictness that was used
  std::vector<StageTime> times;            ///< disjoint, in the order of work
};

/// Cuts the object into grains: cavities -> distance -> power map -> filter -> flow -> graph ->
/// merge -> tidy (the whole of Wang et al. 2014, section 4 and 5; cavities, merging by score or
/// neck, and tidying are ours, and can be turned off).
///
/// The active voxels of `object` are X, active tiles included. Labels depend on nothing but X, the
/// domain, the shape of voxels and the options: not on tiles, threads or the order of work. X
/// empty: zero grains. Voxels that are no cubes, which the mask's transform tells, get the weights
/// of weightsOfEdges() for the object's extent, cavities filled. The interrupter is told each
/// stage's name and the percentage of the whole.
/// @throw InvalidInput if an option is out of range, X leaves the domain, a limit of leaf_index.h
///   is exceeded, there is no background at all, voxels are turned or sheared, no weights fit, or
///   maxMemory is too little; Interrupted if the interrupter says so.
Segmentation segment(const MaskGrid& object, const SegmentOptions& options = {},
                     Interrupter* interrupter = nullptr);

}  // namespace vdb_madf
