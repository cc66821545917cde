// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstdint>

#include "vdb_madf/shapes/detail/shared_mesh.h"

namespace vdb_madf::detail {

/// Collapses edges, those of least error first, until there are at most so many triangles or the
/// next collapse would exceed the error (voxels); see grainMesh(). A site goes to a neighbor, with
/// its points in all grains at once; sites that stay keep their places. Each grain stays a closed
/// surface of the same Euler number in which every edge has two triangles; contacts do not vanish.
/// What is no longer used is dropped. \return false if nothing changed.
/// @throw InvalidInput for a mesh of more than 1,431,655,765 triangles; Interrupted
bool simplify(SharedMesh& mesh, uint64_t triangles, double error, Interrupter* interrupter);

}  // namespace vdb_madf::detail
