// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include "vdb_madf/shapes/grain_mesh.h"

namespace vdb_madf::detail {

/// The surface of one grain in facets of one size: quadrangles, each as two triangles, of about
/// `facet` voxels along a side. OpenVDB makes a level set of the mesh, with samples so far apart,
/// and a mesh of that. So the new mesh is closed whatever the old one is, but what is thinner than
/// a facet may vanish, all of it even; nor is the volume kept. The same for any number of threads.
/// \p mesh: closed, of one grain, not far from the origin. \p facet: > 0
GrainMesh remesh(const GrainMesh& mesh, double facet);

}  // namespace vdb_madf::detail
