// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "vdb_madf/grids/grid_types.h"
#include "vdb_madf/measure/measure_grains.h"

namespace vdb_madf {

/// Mean of n n^T over directions n; its trace is 1. Isotropic: a third on each axis. All 0 if there
/// are none.
using FabricTensor = SymmetricTensor;

/// A sample; lengths in voxels, of unequal ones in their shortest edge (Measurements::edges).
struct SampleMeasures {
  CoordBBox box;             ///< what fractions and correlations refer to, or bounds it
  bool domainKnown = false;  ///< that is the domain; else the box of the grains
  /// The domain is a region of so many voxels: fractions and correlations refer to them.
  std::optional<int64_t> regionVoxels;
  int64_t objectVoxels = 0;
  double objectVolume = 0;  ///< = objectVoxels, of cubes
  double objectFraction = 0;
  double freeArea = 0;         ///< of all grains
  double sharedArea = 0;       ///< of all bonds and of the contacts that were left out
  double specificSurface = 0;  ///< free area per volume of object, 1/voxel
  std::array<std::optional<double>, 3> correlationLengths;  ///< see correlation_length.h
  int64_t eulerCharacteristic = 0;                          ///< components - tunnels + cavities
  int64_t components = 0;                                   ///< 6-connected parts of the object
  std::vector<int64_t> coordinations;                       ///< grains with 0, 1, 2 ... bonds
  double meanCoordination = 0;
  int64_t contactsLeftOut = 0;  ///< pairs of grains that share too few faces for a bond
  double areaLeftOut = 0;       ///< what they share
  int64_t bondsWithoutCurvature = 0;
  FabricTensor grainFabric;  ///< of the grains' longest axes, weighted by volume
  FabricTensor bondFabric;   ///< of the bonds' normals, weighted by area
  /// Mean over the bonds of radius of equal area / radius of the ball of the smaller grain's
  /// volume.
  std::optional<double> bondToGrainRatio;
};

/// Equivalent-sphere diameter below or at which \p share of the grains lie, or of their volume.
/// \p share in [0, 1]; 0 without grains.
double diameterPercentile(const std::vector<GrainMeasures>& grains, double share, bool byVolume);

}  // namespace vdb_madf
