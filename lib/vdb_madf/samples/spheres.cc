// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/samples/spheres.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "vdb_madf/base/errors.h"
#include "vdb_madf/samples/detail/ball_sample.h"
#include "vdb_madf/samples/detail/placement.h"
#include "vdb_madf/samples/detail/sample_options.h"

namespace vdb_madf {

namespace {

constexpr double kMaxOverlap = 100;

void checkOptions(const SphereOptions& options) {
  detail::checkSize(options.size);
  detail::checkCount(options.count);
  detail::checkRadii(options.minRadius, options.maxRadius);
  detail::checkRange("overlap", options.overlap, 0, kMaxOverlap);
  if (options.maxCover < 0) throw InvalidInput("the largest cover must be 1 or more, or 0 for any");
  const int shortest = std::min({options.size.x(), options.size.y(), options.size.z()});
  if (2 * int(std::ceil(options.maxRadius)) > shortest - 1)
    throw InvalidInput("balls of the largest radius do not fit into " + std::to_string(shortest) +
                       " voxels: use a smaller radius or a larger size");
}

}  // namespace

Sample generateSpheres(const SphereOptions& options, Interrupter* interrupter) {
  checkOptions(options);
  const detail::Lattice lattice(options.voxelSize);
  const Coord voxels = lattice.voxels(options.size);
  const std::vector<detail::Ball> balls = detail::placeSpheres(options, interrupter);
  detail::SourceText source("spheres");
  source.size(options.size)
      .add("count", std::to_string(options.count))
      .range("radius", options.minRadius, options.maxRadius)
      .add("overlap", options.overlap)
      .add("max-cover", std::to_string(options.maxCover))
      .add("seed", std::to_string(options.seed))
      .edges(options.voxelSize);
  return detail::described(detail::ballSample(balls, voxels, lattice, interrupter), voxels, source,
                           options.voxelSize);
}

}  // namespace vdb_madf
