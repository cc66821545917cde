// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include "vdb_madf/grids/grid_types.h"

namespace vdb_madf {

/// A copy of a label grid that holds the voxels alone which share a face with another grain, under
/// their own labels: the interfaces, two voxels thick. Name, transform, domain and voxel size are
/// the labels'.
/// @throw Interrupted.
Int32Grid::Ptr interfaceVoxels(const Int32Grid& labels, Interrupter* interrupter = nullptr);

}  // namespace vdb_madf
