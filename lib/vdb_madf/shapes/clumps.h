// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstdint>
#include <vector>

#include "vdb_madf/grids/grid_types.h"

namespace vdb_madf {

/// A grain as some of its medial balls, for discrete-element programs; centers in index
/// coordinates, lengths in shortest edges of a voxel, which are voxels where these are cubes.
struct Clump {
  /// Holds the voxels p with |p - center|^2 < squaredRadius, in space.
  struct Ball {
    Coord center;
    double squaredRadius;  ///< of cubes a whole number, unless it ends at a ball of another grain
  };
  int32_t label = 0;
  std::vector<Ball> balls;  ///< in the order in which they were chosen
  int64_t voxels = 0;       ///< of the grain
  int64_t uncovered = 0;    ///< of them, in no ball
  int64_t outside = 0;      ///< voxels of the balls that are not the grain's, each counted once
  /// Largest distance from the center of a voxel of the grain to the balls: the one-sided Hausdorff
  /// distance from the grain to its balls.
  double farthest = 0;

  /// (volume of the balls' voxels - volume of the grain) / volume of the grain
  double volumeError() const { return voxels ? double(outside - uncovered) / double(voxels) : 0; }
};

/// How many balls a clump has, and what they may leave out.
struct ClumpOptions {
  int mostBalls = 100;          ///< per grain, 1 or more
  double coverageError = 0.02;  ///< part of a grain that may stay uncovered, 0 .. 1
  bool apart = false;           ///< no two balls of different grains overlap; see clumps()
};

/// True if the weights of the balls are those of the labels' voxels, as clumps() wants them.
bool areBallsOfVoxels(const Int32Grid& labels, const Int32Grid& balls);

/// A clump per label (active, > 0), ascending. \p balls: active at the centers of the medial balls,
/// value = squared radius in the unit of its weights (grid `balls` of a segmentation); a ball
/// belongs to the grain of its center, or, if that lies in a filled cavity, to the nearest within
/// the ball and 16 voxels (tie: at the smaller coordinate). Balls are chosen greedily, each the one
/// that covers most voxels of the grain not covered yet (tie: larger, then smaller center), until
/// enough is covered or there are `mostBalls`.
///
/// Medial balls of touching grains overlap near the neck. With `apart` they do not. First, each
/// ends at the nearest voxel of another grain: its squared radius becomes the squared distance to
/// that voxel, if this is less; the cover is chosen from such balls. Then, where two chosen balls
/// of different grains, with radii r and s and centers d apart, still overlap (by less than the
/// diagonal of a voxel), they end at the plane of their equal power, (d^2 + r^2 - s^2) / (2 d) from
/// the first center; of several such planes the nearest counts. A ball of which nothing is left is
/// left out.
///
/// Memory: one bit per voxel of the box of each grain that a thread works on, and with `apart` of
/// the box of its balls, cut to that of all labels; up to 32 MiB a thread for the shapes of balls.
/// The same for any number of threads.
/// @throw InvalidInput for options out of range, or balls whose weights are not those of the
///   labels' voxels; Interrupted.
std::vector<Clump> clumps(const Int32Grid& labels, const Int32Grid& balls,
                          const ClumpOptions& options = {}, Interrupter* interrupter = nullptr);

}  // namespace vdb_madf
