// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <string>

#include "vdb_madf/shapes/hexahedra.h"

namespace vdb_madf {

/// Writes the labeled voxels as hexahedra (hexahedra.h), whole or not at all, by ending:
/// - .vtu: VTK unstructured grid, appended raw; Int32 cell data `grain_id`
/// - .inp: Abaqus (also CalculiX) nodes and C3D8 elements, an element set `grain_000123` per grain;
///   nodes and elements are numbered from 1; node sets `face_x_min`, `face_x_max` to `face_z_max`
///   of the nodes that lie outermost along an axis
/// No labels: no elements.
/// @throw InvalidInput for another ending, or as Hexahedra; IoError; Interrupted.
HexahedraCounts writeHexahedra(const std::string& path, const Int32Grid& labels,
                               Interrupter* interrupter = nullptr);
/// True if writeHexahedra knows the ending.
bool isHexahedraEnding(const std::string& path);

}  // namespace vdb_madf
