// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "vdb_madf/measure/measure_grains.h"

namespace vdb_madf {

/// What leads through the grains and bonds of a sample from the lower to the upper face of its
/// box, normal to an axis. Areas in voxels, of unequal ones in their shortest edge.
struct Crossing {
  /// The bonds of least total area that have to break to part the two faces: the minimum cut
  /// (Hagenmuller et al. 2014 take it over voxels), of several that nearest to the lower face. Of
  /// areas in 2^-20 voxel faces. Nothing leads across: 0. None: a grain reaches from face to face.
  std::optional<double> cutArea;
  int64_t cutBonds = 0;
  double section = 0;  ///< area of a face of the box
  /// What the network of grains conducts between the two faces, which are held at two potentials
  /// while the others are closed, of what the full box would.
  double conductivity = 0;
};

/// What leads across along each axis, and in any direction.
struct Crossings {
  std::array<Crossing, 3> along;  ///< x, y, z
  /// The mean flux through the box for each mean gradient, of what the full box would conduct: all
  /// six faces are held at the potentials of that gradient. Symmetric (Hill 1963). Not below
  /// Crossing::conductivity, and nearer to it the more grains there are.
  SymmetricTensor conductivity;
};

/// A bond in that, along x, y, z.
struct BondCrossing {
  std::array<bool, 3> inCut{};      ///< the minimum cut has it
  std::array<double, 3> current{};  ///< through it, of all that crosses the box; 1e-7 to 1, or 0
};

struct Measurements;

/// Sets Measurements::crossings and BondMeasures::crossing. README.md beside this says which
/// resistance a bond has.
/// @pre measured in a box of known domain, with an open boundary
void measureCrossings(Measurements& measured);

}  // namespace vdb_madf
