// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <memory>
#include <vector>

#include "vdb_madf/samples/detail/ball_union.h"
#include "vdb_madf/samples/detail/gaussian_blur.h"
#include "vdb_madf/samples/detail/particle.h"

namespace vdb_madf::detail {

/// What a sample is made of, as it is between the centers of voxels, and beyond the faces.
class Bodies {
 public:
  virtual ~Bodies() = default;
  /// The share of each voxel that lies in the bodies: of 8 x 8 x 8 points in it, where a surface
  /// may cross it. Sequential.
  virtual FloatBox shares(const CoordBBox& box) const = 0;
};

std::shared_ptr<const Bodies> ballBodies(const std::vector<Ball>& balls, const Lattice& lattice);
std::shared_ptr<const Bodies> particleBodies(const std::vector<Particle>& particles,
                                             const Lattice& lattice);

/// The shares where a field reaches a level that is known at the centers of voxels, and linear
/// along each axis between them. Each face moves in by a voxel.
FloatBox sharesAbove(const FloatBox& field, float level);

}  // namespace vdb_madf::detail
