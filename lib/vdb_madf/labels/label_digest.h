// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <string>

#include "vdb_madf/grids/grid_types.h"

namespace vdb_madf {

/// A checksum of the places and labels of the labeled voxels, 32 hexadecimal digits: equal labels
/// have equal digests, whatever file or grid they come from. It is the one that measure() gives.
/// @throw InvalidInput as LeafIndex does; Interrupted.
std::string labelDigest(const Int32Grid& labels, Interrupter* interrupter = nullptr);

}  // namespace vdb_madf
