// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/samples/detail/ball_sample.h"

#include "vdb_madf/samples/detail/bodies.h"
#include "vdb_madf/samples/detail/power_cells.h"

namespace vdb_madf::detail {

Sample ballSample(const std::vector<Ball>& balls, const Coord& voxels, const Lattice& lattice,
                  Interrupter* interrupter) {
  BallUnion object(voxels, false, lattice);
  object.add(balls, interrupter);
  Sample sample;
  sample.object = MaskGrid::create(object.takeTree());
  sample.truth = Int32Grid::create(powerCells(sample.object->tree(), balls, interrupter, lattice));
  sample.bodies = ballBodies(balls, lattice);
  return sample;
}

}  // namespace vdb_madf::detail
