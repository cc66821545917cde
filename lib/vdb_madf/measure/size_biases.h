// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <string>
#include <vector>

#include "vdb_madf/measure/measure.h"

namespace vdb_madf {

/// A number for which the grains or bonds are too small.
struct SizeBias {
  /// "grains", "specific_surface", "mean_coordination", "bond_area"; with necks in a scan also
  /// "neck_area", "contact_coordination".
  std::string number;
  double expected = 0;  ///< by which share it comes out too large, below 0: too small
  /// The median of the grains by volume, or of the bonds, in edges of a cube as large as a voxel.
  double radius = 0;
  double enough = 0;  ///< radius from which on it is within kTrusted
};

constexpr double kTrusted = 0.05;

/// The numbers that are expected to be off by more than kTrusted: as they are of equal balls that
/// touch in points (of areas of bonds: of overlapping ones), clean or, for labels of a gray scan,
/// through the blur that the scan tells, and what smoothing adds to it, with noise of 5 %
/// (tests/benchmark/packs). Where nothing tells the blur it is taken for 0.7 voxel, and for 1 voxel
/// where it is wider. Of a slice, none.
std::vector<SizeBias> sizeBiases(const Measurements& measured);

/// Such as "specific_surface about -14 % at a median radius of 4.1 voxels (within 5 % from 12 on)".
std::string toString(const SizeBias& bias);

}  // namespace vdb_madf
