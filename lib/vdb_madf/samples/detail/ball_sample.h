// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <vector>

#include "vdb_madf/samples/detail/ball_union.h"
#include "vdb_madf/samples/sample.h"

namespace vdb_madf::detail {

/// The union of balls in voxels [0, voxels - 1], parted as powerCells() says. @throw Interrupted
Sample ballSample(const std::vector<Ball>& balls, const Coord& voxels, const Lattice& lattice,
                  Interrupter* interrupter);

}  // namespace vdb_madf::detail
