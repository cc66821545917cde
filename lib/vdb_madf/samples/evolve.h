// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "vdb_madf/grids/grid_metadata.h"
#include "vdb_madf/grids/grid_types.h"
#include "vdb_madf/matching/match_grains.h"

namespace vdb_madf {

/// How a sample moves and loses grains, in steps. After step k of n, with t = k / n, what was at p
/// is at c + R S (p - c) + t * drift: c is the center of the box, S shortens and shears by t of
/// what is given, R turns by t of the angle.
struct EvolveOptions {
  int steps = 2;                  ///< n, 1..1000
  uint64_t seed = 1;              ///< of noise, and of what vanishes
  double strain = 0;              ///< shortening along z, -0.9..0.9
  double shear = 0;               ///< of x along z, -2..2
  double degrees = 0;             ///< of the turn, -180..180
  openvdb::Vec3d axis{0, 0, 1};   ///< of the turn
  openvdb::Vec3d drift{0, 0, 0};  ///< voxels
  /// Centers of grains move as above, but each grain keeps its shape and turns by R about its own.
  /// Where several would have a voxel, it goes to the one whose center is nearest in radii.
  bool rigidGrains = false;
  double vanish = 0;  ///< share of the grains that has vanished after the last step, 0..1
  /// A voxel looks for its label this far from where it should, by white noise along each axis: its
  /// standard deviation in voxels, 0..4; not at step 0. It is seen at boundaries alone.
  double noise = 0;
};

/// @throw InvalidInput for options out of range.
void checkEvolve(const EvolveOptions& options);

enum class EvolvedFate {
  kept,
  left,  ///< a part of it, or all, lies beyond the domain
  vanished
};
const char* toString(EvolvedFate fate);

/// A grain after a step.
struct EvolvedGrain {
  int32_t grain = 0;
  EvolvedFate fate = EvolvedFate::kept;
  int64_t voxels = 0;
  openvdb::Vec3d center;  ///< where its center of mass has gone, in voxels
};

/// A sample after a step, and the truth of it.
struct EvolvedStep {
  Int32Grid::Ptr labels;  ///< named `grain`, with the numbers and within the box of before
  Motion motion;
  std::vector<EvolvedGrain> grains;  ///< all of before, ascending
};

/// Labels that move. What is known of them beforehand is found once, for all steps.
class Evolution {
 public:
  /// @throw InvalidInput for options out of range, or voxels that are no cubes; Interrupted.
  Evolution(const Int32Grid& labels, const EvolveOptions& options,
            Interrupter* interrupter = nullptr);

  /// The labels after a step (0: as they are). A voxel takes the label of the voxel that it lies in
  /// when it is moved back. Where the domain is unknown, no grain leaves. The same bits on every
  /// machine. Memory: that of the labels before and, also beyond the domain, after.
  /// @throw InvalidInput if there is no such step; Interrupted.
  EvolvedStep after(int step, Interrupter* interrupter = nullptr) const;

 private:
  EvolveOptions options_;
  Int32Tree::ConstPtr tree_;  ///< without tiles
  std::optional<Domain> domain_;
  std::optional<VoxelSize> voxelSize_;
  openvdb::Vec3d center_;  ///< of the box
  GrainSet before_;
};

}  // namespace vdb_madf
