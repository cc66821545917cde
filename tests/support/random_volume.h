// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "support/dense_volume.h"

namespace vdb_madf::test {

/// splitmix64 (Steele, Lea & Flood 2014): the same numbers everywhere, unlike the distributions of
/// <random>.
class Rng {
 public:
  explicit Rng(uint64_t seed) : state_(seed) {}
  uint64_t next();
  int below(int end);                                                           ///< 0 .. end - 1
  int between(int first, int last) { return first + below(last - first + 1); }  ///< inclusive
  double unit();                                                                ///< [0, 1)
  bool chance(double probability) { return unit() < probability; }

 private:
  uint64_t state_;
};

/// Kinds of test objects. Each leaves its box partly empty or not, as its name says.
enum class VolumeKind {
  empty,
  oneVoxel,
  fullBlock,       ///< the whole box
  allButOneVoxel,  ///< the whole box without one voxel
  touchingFaces,   ///< a ball cut by some faces of the box
  oneVoxelSheet,   ///< flat, one voxel thick, across one axis
  twoEqualMaxima,  ///< two equal balls on an axis, overlapping, touching or apart
  wholeLeaves,     ///< full 8x8x8 blocks of the leaf grid, for active tiles
  twoComponents,   ///< two boxes or balls with a gap
  sparseNoise,     ///< 1 to 20 % object
  denseNoise,      ///< 40 to 98 % object
  ballUnion,       ///< smooth
  blurredNoise,    ///< rounded blobs and necks
  roughBalls,      ///< balls with noise near their surface
  boxUnion,        ///< many equal distances
  thinRods,        ///< along the axes, one or two voxels thick
  comb,            ///< teeth on a back: concave, many equal distances
  hollowShell,     ///< a ball or box with a cavity
  pinholes,        ///< something smooth with small holes, single voxels and larger
  checkerboard,    ///< no voxel has a 6-neighbour
  count_
};
constexpr int kVolumeKinds = int(VolumeKind::count_);
std::string name(VolumeKind kind);

/// An object of that kind in the box, whose origin need not be positive.
ObjectVolume randomVolume(VolumeKind kind, const CoordBBox& box, Rng& rng);

/// Where the volume lies: at 0, near a leaf or tile border, negative, far out.
Coord randomOrigin(Rng& rng);

/// Non-cubic, sides 1 to 32: mostly small ones.
Coord randomSize(Rng& rng);

/// Unknown, the bounding box of the object (so that it touches all faces), the volume's box, or
/// larger on some sides. Always holds the object.
std::optional<CoordBBox> randomDomain(const ObjectVolume& object, Rng& rng);

}  // namespace vdb_madf::test
