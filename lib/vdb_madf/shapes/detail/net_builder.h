// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include "vdb_madf/labels/detail/label_blocks.h"
#include "vdb_madf/shapes/detail/surface_net.h"

namespace vdb_madf::detail {

/// The net of the voxels' faces, without smoothing; links and junctions only if wanted.
/// \param domain: empty if it is not known; holds all labels
/// @throw InvalidInput for more than 2^32 - 1 points or triangles; Interrupted.
SurfaceNet buildNet(const LabelBlocks& blocks, const CoordBBox& domain, bool withLinks,
                    Interrupter* interrupter);

}  // namespace vdb_madf::detail
