// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include "vdb_madf/matching/track.h"
#include "vdb_madf/measure/grain_network.h"

namespace vdb_madf::tools {

/// The grains and bonds of before, with what became of them, for writeNetwork(). Grains have
/// `voxels`, `fate` (its position in GrainFate), `partner` (0: none), `confidence`, `miss`,
/// `displacement_x`, `_y`, `_z`, `strain_volumetric`, `strain_deviatoric`, `rotation_x`, `_y`, `_z`
/// (degrees); bonds `faces` and `fate` (its position in BondFate). Places and displacements are in
/// world units. NaN: not known.
/// @pre tracked with a motion
GrainNetwork motionNetwork(const AnyLabels& before, const Tracks& tracks);

}  // namespace vdb_madf::tools
