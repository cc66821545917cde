// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include "vdb_madf/samples/detail/gaussian_blur.h"

namespace vdb_madf::detail {

/// Distance of each voxel from the surface of the object (values 1; air is 0), negative inside: to
/// the nearest voxel of the other kind, less a half. Where the field is known around a voxel: each
/// face moves in by `reach`. Distances that exceed `reach` come out as some value beyond it.
FloatBox surfaceDistance(const FloatBox& object, int reach);

}  // namespace vdb_madf::detail
