// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <string>

#include "vdb_madf/measure/grain_network.h"

namespace vdb_madf {

/// Writes the network as a bonded-particle model in MUSEN's text format, whole or not at all:
/// - a sphere a grain, of its volume, around its centroid, by the number of its label
/// - a solid bond a bond, numbered on after the largest label: a cylinder of the interface's area,
///   as long as from centroid to centroid, so that it is at rest
/// - the compounds `grain` and `bond`, whose properties are those that MUSEN gives a new one
/// - a simulation domain that holds the spheres
/// Lengths are in meters.
/// @throw InvalidInput without a voxel size (GrainNetwork::unit); IoError; Interrupted.
void writeMusen(const std::string& path, const GrainNetwork& network,
                Interrupter* interrupter = nullptr);

}  // namespace vdb_madf
