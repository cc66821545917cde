// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <openvdb/Types.h>

#include <array>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "vdb_madf/base/interrupter.h"

namespace vdb_madf {

/// What is known of a grain of a scan. Lengths are of any unit, the same in both scans.
struct GrainFeatures {
  int32_t grain = 0;                ///< its number
  openvdb::Vec3d center;            ///< of mass
  double volume = 0;                ///< above 0
  std::array<double, 6> moments{};  ///< covariance of its places: xx, yy, zz, xy, xz, yz
  bool isCut = false;  ///< the scan ends within it: all this is of the part that is seen
};

/// The grains of a scan, ascending by number, and the pairs of numbers that touch.
struct GrainSet {
  std::vector<GrainFeatures> grains;
  std::vector<std::pair<int32_t, int32_t>> contacts;  ///< may be left out
};

/// What was at p is at linear * p + shift.
struct Motion {
  openvdb::Mat3d linear = openvdb::Mat3d::identity();
  openvdb::Vec3d shift{0, 0, 0};

  openvdb::Vec3d operator()(const openvdb::Vec3d& p) const { return linear * p + shift; }
};

/// Takes next to no time. @throw InvalidInput unless it is finite, and its determinant above 0
void checkMotion(const Motion& motion);

/// How a sample has moved as a whole.
enum class MotionKind {
  rigid,   ///< it was turned and shifted
  affine,  ///< it was also strained
  free     ///< nothing is said of the whole; neighbors move alike
};

/// What is known of the motion.
struct MatchOptions {
  MotionKind kind = MotionKind::affine;
  std::optional<Motion> guess;  ///< of the whole: is near it
};

/// Where a grain of before went.
struct FollowedGrain {
  int32_t partner = 0;            ///< its number after; 0: lost
  double confidence = 0;          ///< 0.88 to 1; 0: lost; see matchGrains()
  bool isPlaced = false;          ///< its neighbors, or the whole, tell where it should be
  openvdb::Vec3d place{0, 0, 0};  ///< there
  openvdb::Mat3d nearby = openvdb::Mat3d::identity();  ///< the gradient of what tells its place
  double miss = 0;                                     ///< from there to the partner's center
  bool isCut = false;  ///< it or its partner is: how its center has moved tells nothing
  int neighbors = 0;   ///< followed ones, not cut, that the gradient was fitted to
  /// Deformation gradient: by least squares, with intercept, of the grain, unless it is cut, and
  /// these neighbors; of fewer than 6, or of such in a plane: none. If there is one, it says the
  /// place of a grain that is cut.
  std::optional<openvdb::Mat3d> gradient;
};

/// Where all of them went.
struct FollowedGrains {
  std::optional<Motion> whole;        ///< unless the motion is free
  std::vector<FollowedGrain> grains;  ///< as those of before
  int64_t count = 0;                  ///< of those that were followed
};

/// Follows grains by their features alone. First a place is looked for where the neighborhood of a
/// grain before, moved by some affine motion, lies on that of a grain after; then what is followed
/// grows from there: a grain is expected where its followed neighbors say, by an affine fit that
/// clings to their gradient, and its candidates are the grains around there of 0.6 to 1.6 times its
/// volume. They cost the distance in mean distances of neighbors, and besides what differs of the
/// logarithm of the volume, of the (turned) moments and of the contacts. A match is the cheapest
/// for both, and for both any other is at least 1.6 times as expensive; all others are lost. This
/// is repeated until nothing changes, at last with candidates no farther than four times the
/// median (and 0.3 to 0.5 spacings). Specks, grains that hold under a fiftieth of the volume of the
/// grain in the middle of the mass, and under a tenth of the mass together, are nobody's neighbors;
/// they are followed if most of them are found, else all are lost. Grains that are cut are followed
/// as others are, but say nothing of gradients, nor of the motion of the whole if four do.
/// The confidence is the probability that a match is right: 1 - 0.12 (1 - s)^5, where s is 1 - cost
/// / cost of the next best, times the share of the nearest 12 grains that are followed (two thirds
/// of them are enough). The formula is calibrated on moved packs (tests/benchmark/README.md); where
/// a scan has few grains of the other one it promises too much.
/// Deterministic: ties go to the smaller number. N log N. Memory: per grain.
/// @return nothing if no such place is found, and there is no guess
/// @throw InvalidInput if numbers do not ascend, a feature is not finite, or a guess is none (see
///   checkMotion()); Interrupted
std::optional<FollowedGrains> matchGrains(const GrainSet& before, const GrainSet& after,
                                          const MatchOptions& options = {},
                                          Interrupter* interrupter = nullptr);

/// What a deformation gradient F = R U does. E = (F^T F - 1) / 2 is the Green-Lagrange strain.
struct Strain {
  double volumetric = 0;         ///< trace of E
  double deviatoric = 0;         ///< sqrt(2/3 D:D), D being E without a third of its trace
  openvdb::Vec3d turn{0, 0, 0};  ///< R: the axis, as long as the angle in degrees
};
Strain strainOf(const openvdb::Mat3d& gradient);
/// R; the identity of what has none.
openvdb::Mat3d rotationOf(const openvdb::Mat3d& gradient);

}  // namespace vdb_madf
