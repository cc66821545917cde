// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstdint>
#include <vector>

#include "vdb_madf/shapes/detail/shared_mesh.h"

namespace vdb_madf::detail {

/// Moves the sites along the gradients of the grains' volumes until these are \p volumes (voxels;
/// to 0.1 %), each at most `reach` along an axis from its place in \p homes; those on a face of the
/// domain within it.
/// @throw Interrupted
void correctVolumes(SharedMesh& mesh, const std::vector<int64_t>& volumes,
                    const std::vector<openvdb::Vec3f>& homes, float reach,
                    const DomainFaces& domain, Interrupter* interrupter);

}  // namespace vdb_madf::detail
