// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/matching/match_grains.h"

#include <cmath>
#include <limits>
#include <string>

#include "vdb_madf/base/errors.h"
#include "vdb_madf/matching/detail/following.h"
#include "vdb_madf/matching/detail/local_fit.h"
#include "vdb_madf/matching/detail/scan_grains.h"
#include "vdb_madf/matching/detail/seed_search.h"

namespace vdb_madf {

using openvdb::Mat3d;
using openvdb::Vec3d;

namespace {

void check(const GrainSet& set) {
  int64_t last = std::numeric_limits<int64_t>::min();
  for (const GrainFeatures& grain : set.grains) {
    if (grain.grain <= last) throw InvalidInput("the numbers of grains have to ascend");
    last = grain.grain;
    bool isFine = std::isfinite(grain.volume) && grain.volume > 0;
    for (int axis = 0; axis < 3; ++axis) isFine = isFine && std::isfinite(grain.center[axis]);
    for (const double moment : grain.moments) isFine = isFine && std::isfinite(moment);
    if (!isFine)
      throw InvalidInput("grain " + std::to_string(grain.grain) +
                         " has no finite center, volume and moments");
  }
}

}  // namespace

void checkMotion(const Motion& motion) {
  const double determinant = motion.linear.det();
  if (!motion.shift.isFinite() || !std::isfinite(determinant))
    throw InvalidInput("the numbers of a motion must be finite");
  if (!(determinant > 0)) throw InvalidInput("the determinant of the matrix must be above 0");
}

std::optional<FollowedGrains> matchGrains(const GrainSet& before, const GrainSet& after,
                                          const MatchOptions& options, Interrupter* interrupter) {
  check(before);
  check(after);
  if (options.guess) checkMotion(*options.guess);
  const detail::ScanGrains first(before, interrupter), second(after, interrupter);
  const detail::SeedSearch search(first, second, options);
  std::optional<detail::Following> following;
  bool isSound = false;
  for (size_t k = 0; k < search.count() && !isSound; ++k) {
    const auto seed = search(k, interrupter);
    if (!seed) continue;
    following.emplace(first, second);
    following->take(*seed);
    following->settle(interrupter);
    isSound = following->isSound();
  }
  if (!isSound) {
    if (!options.guess) return std::nullopt;
    following.emplace(first, second);
    following->setWhole(*options.guess);
    following->settle(interrupter);
  }
  if (options.kind != MotionKind::free)
    if (const auto whole = following->wholeOf(options.kind)) {
      following->setWhole(*whole);
      following->settle(interrupter);
    }
  following->finish(interrupter);
  return following->result();
}

Mat3d rotationOf(const Mat3d& gradient) {
  return detail::turnOf(gradient);
}

Strain strainOf(const Mat3d& gradient) {
  Strain strain;
  const Mat3d green = (gradient.transpose() * gradient - Mat3d::identity()) * 0.5;
  strain.volumetric = detail::trace(green);
  const Mat3d rest = green - Mat3d::identity() * (strain.volumetric / 3);
  strain.deviatoric = std::sqrt(2. / 3 * detail::squaredNorm(rest));
  const Mat3d turn = rotationOf(gradient);
  // The antisymmetric part has the sine of the angle, the trace its cosine.
  const Vec3d sine =
      Vec3d(turn(2, 1) - turn(1, 2), turn(0, 2) - turn(2, 0), turn(1, 0) - turn(0, 1)) * 0.5;
  const double length = sine.length(), cosine = (detail::trace(turn) - 1) / 2;
  if (length > 0)
    strain.turn = sine * (std::atan2(length, cosine) * (180 / 3.141592653589793) / length);
  return strain;
}

}  // namespace vdb_madf
