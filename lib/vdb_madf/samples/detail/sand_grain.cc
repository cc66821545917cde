// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/samples/detail/sand_grain.h"

#include <algorithm>
#include <vector>

#include "vdb_madf/base/detail/portable_math.h"

namespace vdb_madf::detail {

namespace {

using openvdb::Vec3d;

/// Quantiles of 10, 25, 50, 75 and 90 %.
using Quantiles = std::array<double, 5>;

/// Bumps and dents of one size: how many, and the cosine of the angle from their middle to their
/// rim.
struct BumpSize {
  int count;
  double rim;
};
constexpr BumpSize kBumpSizes[] = {{8, 0.2}, {24, 0.7}, {80, 0.9}};

/// What is known of a sand, and what makes grains like its: how high the bumps of each size are in
/// the median grain, and the standard deviation of the logarithm of that over the grains.
struct Sand {
  Quantiles flatness, elongation;
  double flatnessShare, elongationShare;  ///< of the ellipsoid's deviation from a ball in these
  std::array<double, 3> heights;
  double spread;
};

/// In the order of ParticleShape. Flatness and elongation are those of Sand Atlas (by X-ray
/// tomography, CC BY 4.0).
constexpr Sand kSands[] = {{{0.624, 0.695, 0.776, 0.848, 0.905},
                            {0.626, 0.692, 0.767, 0.842, 0.898},
                            0.87,
                            0.895,
                            {0.0692, 0.1723, 0.0117},
                            0.204},
                           {{0.599, 0.664, 0.743, 0.832, 0.892},
                            {0.596, 0.656, 0.746, 0.822, 0.888},
                            0.972,
                            0.977,
                            {0.0903, 0.044, 0.115},
                            0.156},
                           {{0.608, 0.685, 0.772, 0.853, 0.909},
                            {0.621, 0.696, 0.777, 0.851, 0.907},
                            0.9,
                            0.896,
                            {0.0794, 0.1544, 0.0629},
                            0.304},
                           {{0.570, 0.660, 0.716, 0.780, 0.859},
                            {0.510, 0.647, 0.765, 0.816, 0.869},
                            0.971,
                            0.938,
                            {0.0567, 0.0881, 0.1779},
                            0.147}};

/// Linear between the quantiles, and a little beyond them.
double ratioAt(const Quantiles& quantiles, double share) {
  constexpr double kShares[] = {0, 0.1, 0.25, 0.5, 0.75, 0.9, 1};
  const double least = quantiles[0] - 0.9 * (quantiles[1] - quantiles[0]);
  const double greatest = std::min(0.99, quantiles[4] + 0.8 * (quantiles[4] - quantiles[3]));
  const double ratios[] = {least,        quantiles[0], quantiles[1], quantiles[2],
                           quantiles[3], quantiles[4], greatest};
  size_t i = 0;
  while (i < 5 && share > kShares[i + 1]) ++i;
  const double part = (share - kShares[i]) / (kShares[i + 1] - kShares[i]);
  return ratios[i] + part * (ratios[i + 1] - ratios[i]);
}

/// Bumps have a part in a grain's moments: its ellipsoid is closer to a ball.
double closerToOne(double ratio, double share) {
  return 1 - share * (1 - ratio);
}

struct Bump {
  Vec3d middle;
  double rim;
  double height;  ///< in radii; of dents it is negative
};

std::vector<Bump> drawBumps(const Sand& sand, RandomSequence& random) {
  const double size = exponential(sand.spread * std::clamp(random.normal(), -2.0, 2.0));
  std::vector<Bump> bumps;
  for (size_t i = 0; i < 3; ++i)
    for (int k = 0; k < kBumpSizes[i].count; ++k) {
      const Vec3d middle = drawDirection(random);
      const double sign = random.uniform() < 0.5 ? 1 : -1;
      const double height = sign * sand.heights[i] * size * random.uniform(0.5, 1.5);
      bumps.push_back({middle, kBumpSizes[i].rim, height});
    }
  return bumps;
}

double radiusAt(const std::vector<Bump>& bumps, const Vec3d& direction) {
  double radius = 1;
  for (const Bump& bump : bumps) {
    const double x = (bump.middle.dot(direction) - bump.rim) / (1 - bump.rim);
    if (x > 0) radius += bump.height * x * x;
  }
  return std::clamp(radius, 0.5, 1.7);
}

}  // namespace

SandGrain drawSandGrain(ParticleShape shape, RandomSequence& random) {
  const Sand& sand = kSands[int(shape) - int(ParticleShape::sandOttawa)];
  const double flatness = closerToOne(ratioAt(sand.flatness, random.uniform()), sand.flatnessShare);
  const double elongation =
      closerToOne(ratioAt(sand.elongation, random.uniform()), sand.elongationShare);
  const std::vector<Bump> bumps = drawBumps(sand, random);
  return {{1, elongation, elongation * flatness},
          DirectionMap([&](const Vec3d& direction) { return 1 / radiusAt(bumps, direction); })};
}

}  // namespace vdb_madf::detail
