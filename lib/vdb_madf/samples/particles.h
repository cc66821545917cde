// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "vdb_madf/base/voxel_size.h"
#include "vdb_madf/samples/sample.h"

namespace vdb_madf {

/// Particles, convex but for sand. Axes and sides vary a little from particle to particle.
enum class ParticleShape {
  balls,
  ellipsoids,  ///< axes about 1 : 1.3 : 1.7
  plates,      ///< flat hexagonal prisms, as high as a third of their width
  prisms,      ///< hexagonal prisms, twice as high as wide
  polyhedra,   ///< 8 to 14 random half-spaces, cut by a cube of 3.2 times their distance
  rods,        ///< the points within some radius of a line segment: straight, with round ends
  columns,     ///< hexagonal prisms as long as asked for
  // Ellipsoids with bumps and dents, whose sphericity, convexity, flatness and elongation have the
  // quantiles of grains of real sands (Sand Atlas) to 3 %: Ottawa, rounded, and its fine part;
  // Hamburg, of a quarry; Hostun, angular, of which 54 grains are known, to 7 %.
  sandOttawa,
  sandOttawaFine,
  sandHamburg,
  sandHostun,
};

/// Whether ParticleOptions::minAspect and maxAspect have a meaning: for rods and columns.
bool haveAspect(ParticleShape shape);

bool isSand(ParticleShape shape);

/// The names of the enumerators, in their order.
const std::vector<std::string>& particleShapeNames();

/// Particles of one shape with known grains, turned at random, cropped at the faces. Their size is
/// the radius of the ball of equal volume (of polyhedra to 2 %, of sand to 1 %). Centers are
/// uniform in the box, where
/// - the distance of two centers is at least `neck` times the sum of what the line between them
///   passes inside the two particles;
/// - no voxel lies in two particles that are shrunk to `neck` of their size about their centers.
/// For balls these say the same. Each particle keeps its size and orientation, and tries up to
/// 50000 centers.
///
/// The object is the union. Truth = the particle of least value at the voxel, where the value is
/// the factor by which a particle would have to be scaled about its center to reach the voxel
/// (tie: the smaller number). A particle that owns no voxel is no grain. Of a sharp corner a voxel
/// or two may be left that no face joins to their grain.
struct ParticleOptions {
  Coord size{180, 180, 180};
  uint64_t seed = 1;
  ParticleShape shape = ParticleShape::ellipsoids;
  int count = 140;
  double minRadius = 12, maxRadius = 22;
  /// 0: radii are uniform; else the standard deviation of their logarithm about that of the
  /// geometric mean of the two, and a radius beyond them is drawn again. 0..1
  double lognormal = 0;
  /// Length over thickness of rods and columns, uniform; no other shape has it. The length of a rod
  /// has the round ends in it; a column is as thick as the distance of opposite sides. 1..100
  double minAspect = 4, maxAspect = 8;
  double neck = 0.82;                  ///< 0..2; from 1 on no voxel lies in two particles
  std::optional<VoxelSize> voxelSize;  ///< need not be cubes: see sample.h
};
Sample generateParticles(const ParticleOptions& options, Interrupter* interrupter = nullptr);

}  // namespace vdb_madf
