// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include "vdb_madf/samples/detail/gaussian_blur.h"

namespace vdb_madf::detail {

/// The WhiteNoise of (seed, stream) at the points of a box. Parallel if the box is large.
/// @throw Interrupted
FloatBox whiteNoise(const CoordBBox& box, uint64_t seed, uint64_t stream, Interrupter* interrupter);

}  // namespace vdb_madf::detail
