// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include "vdb_madf/base/interrupter.h"
#include "vdb_madf/grids/grid_types.h"

namespace vdb_madf {

/// A synthetic object in [0, size - 1], with its domain in the metadata, and in `madf_source` the
/// command that makes it. The same options give the same bits on every machine and for any number
/// of threads. Lengths are in voxels; size is 1 to 26754 along each axis, radii are 0.5 or more.
///
/// Each generator @throw InvalidInput for options out of range, or that cannot be met; Interrupted.
struct Sample {
  MaskGrid::Ptr object;  ///< named `object`
  /// Named `truth`, the object's topology but for specks of noise (scan.h): labels 1..N of the true
  /// grains, numbered by the centers of their balls or particles (x, then y, then z). Null where
  /// there is no truth.
  Int32Grid::Ptr truth;
};

}  // namespace vdb_madf
