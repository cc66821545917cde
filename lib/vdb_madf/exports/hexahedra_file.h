// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstddef>
#include <string>

#include "vdb_madf/grids/grid_types.h"

namespace vdb_madf {

/// One element per voxel: more are some gigabytes of text, and more than solvers take.
constexpr size_t kMaxHexahedra = 20000000;

struct HexahedraCounts {
  size_t grains = 0, elements = 0, nodes = 0;
};

/// Writes every labelled voxel (active, tiles included, > 0) as a hexahedron, whole or not at all,
/// by ending:
/// - .vtu: VTK unstructured grid, appended raw; Int32 cell data `grain_id`
/// - .inp: Abaqus (also CalculiX) nodes and C3D8 elements, an element set `grain_000123` per grain;
///   nodes and elements are numbered from 1
/// Corners are the voxel's centre +- half a voxel, in the world. Voxels that share a corner share
/// the node, those of other grains too: bonds are perfect, and voxels that touch along an edge or
/// at a corner only are hinged there. Elements are ordered by label, then by place, nodes by place:
/// the same for any number of threads. No labels: no elements.
/// Memory: some 20 bytes per voxel.
/// @throw InvalidInput for another ending, voxels that are not cubes along the axes, more than
///   kMaxHexahedra voxels or a limit of leaf_index.h; IoError; Interrupted.
HexahedraCounts writeHexahedra(const std::string& path, const Int32Grid& labels,
                               Interrupter* interrupter = nullptr);
/// True if writeHexahedra knows the ending.
bool isHexahedraEnding(const std::string& path);

}  // namespace vdb_madf
