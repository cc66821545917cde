// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstdint>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "vdb_madf/grids/grid_metadata.h"
#include "vdb_madf/grids/grid_types.h"
#include "vdb_madf/matching/match_grains.h"
#include "vdb_madf/method/boundary.h"

namespace vdb_madf {

/// How a sample moves, and what it gains and loses, in steps. After step k of n, with t = k / n,
/// what was at p is at c + R S (p - c) + t * drift: c is the center of the box, S shortens and
/// shears by t of what is given, R turns by t of the angle.
struct EvolveOptions {
  int steps = 2;                  ///< n, 1..1000
  uint64_t seed = 1;              ///< of noise, and of what vanishes, enters and breaks
  double strain = 0;              ///< shortening along z, -0.9..0.9
  double shear = 0;               ///< of x along z, -2..2
  double degrees = 0;             ///< of the turn, -180..180
  openvdb::Vec3d axis{0, 0, 1};   ///< of the turn
  openvdb::Vec3d drift{0, 0, 0};  ///< voxels
  /// Centers of grains move as above, but each grain keeps its shape and turns by R about its own.
  /// Where several would have a voxel, it goes to the one whose center is nearest in radii.
  bool rigidGrains = false;
  double vanish = 0;  ///< share of the grains that has vanished after the last step, 0..1
  double enter = 0;   ///< share of the grains that is not there at step 0, and is at the last, 0..1
  double breaks = 0;  ///< share of the bonds that has broken after the last step, 0..1
  /// Where a bond has broken, both grains lose what lies so near to the other, from center to
  /// center, in voxels, 1..8.
  int gap = 2;
  /// Voxels by which grains have grown at the end into what is empty, before they are moved; below
  /// 0: by which they have dissolved; -8..8. Each voxel goes to the nearest grain.
  double growth = 0;
  /// A voxel looks for its label this far from where it should, by white noise along each axis: its
  /// standard deviation in voxels, 0..4; not at step 0. It is seen at boundaries alone.
  double noise = 0;
};

/// @throw InvalidInput for options out of range.
void checkEvolve(const EvolveOptions& options);

enum class EvolvedFate {
  kept,
  left,  ///< a part of it, or all, lies beyond the domain
  vanished,
  absent  ///< it has not entered yet
};
const char* toString(EvolvedFate fate);

enum class EvolvedBondFate {
  kept,
  broken,  ///< as was asked for
  parted,  ///< it was not to break, but no voxels share a face any longer
  gone,    ///< a grain of it is not kept
  created  ///< it was not there before
};
const char* toString(EvolvedBondFate fate);  ///< "kept", ..., "new" for created

/// A grain after a step.
struct EvolvedGrain {
  int32_t grain = 0;
  EvolvedFate fate = EvolvedFate::kept;
  int64_t voxels = 0;
  openvdb::Vec3d center;  ///< where its center of mass before has gone, in voxels
};

/// Two grains that touch, before or after a step.
struct EvolvedBond {
  int32_t first = 0, second = 0;
  EvolvedBondFate fate = EvolvedBondFate::kept;
  int64_t faces = 0;  ///< after
};

/// A sample after a step, and the truth of it.
struct EvolvedStep {
  Int32Grid::Ptr labels;  ///< named `grain`, with the numbers, domain and boundary of before
  Motion motion;
  std::vector<EvolvedGrain> grains;  ///< all of before, ascending
  std::vector<EvolvedBond> bonds;    ///< by first, then second
};

/// Labels that move. What is known of them beforehand is found once, for all steps.
class Evolution {
 public:
  /// @throw InvalidInput for options out of range, or voxels that are no cubes; Interrupted.
  Evolution(const Int32Grid& labels, const EvolveOptions& options,
            Interrupter* interrupter = nullptr);

  /// The labels after a step (0: as they are, but for what enters). A voxel takes the label of the
  /// voxel that it lies in when it is moved back. Where the domain is unknown, no grain leaves. The
  /// same bits on every machine. Memory: that of the labels before and, also beyond the domain,
  /// after.
  /// @throw InvalidInput if there is no such step; Interrupted.
  EvolvedStep after(int step, Interrupter* interrupter = nullptr) const;

 private:
  std::vector<EvolvedBond> bondsOf(const EvolvedStep& step,
                                   const std::set<std::pair<int32_t, int32_t>>& broken,
                                   Interrupter* interrupter) const;

  EvolveOptions options_;
  Int32Tree::ConstPtr tree_;  ///< without tiles
  std::optional<Domain> domain_;
  Boundary boundary_;
  std::optional<VoxelSize> voxelSize_;
  openvdb::math::Transform::ConstPtr transform_;
  openvdb::Vec3d center_;  ///< of the box
  GrainSet before_;
};

}  // namespace vdb_madf
