// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstdint>
#include <string>

#include "vdb_madf/exports/detail/world_mesh.h"

namespace vdb_madf::detail {

/// Writes glTF 2.0 (Khronos, ISO/IEC 12113) as one binary file: a header, a chunk of JSON and one
/// of numbers. @throw InvalidInput if that is more than the 4 GiB of such a file; IoError;
/// Interrupted.
void writeGlb(const std::string& path, const WorldMesh& world, const MeshFileOptions& options,
              Interrupter* interrupter);

/// @throw InvalidInput if a .glb surely is too small for such a mesh.
void checkGlbRoom(const std::string& path, uint64_t points, uint64_t triangles, bool hasNormals);

}  // namespace vdb_madf::detail
