// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstdint>
#include <string>

#include "vdb_madf/base/voxel_size.h"

namespace vdb_madf {

// Sizes as users write them, with their unit: a number alone is refused, for it may be meant in
// another one. All are read alike in every locale. @throw InvalidInput that begins with the text

/// "8.5um", "0.5x0.5x1.2um" (x, y, z; or a unit for each), with or without spaces; units as
/// unitsPerMetre() knows them. Edges lie between 0.1 nm and 1 m.
VoxelSize voxelSizeFromText(const std::string& text);

/// "500M", "12 GiB", "1e6B" in bytes; K, M, G, T with or without iB are powers of 1024, with B of
/// 1000; upper and lower case are the same.
int64_t bytesFromText(const std::string& text);

/// A finite number without a unit, such as a threshold. The decimal sign is a point in every
/// locale.
double numberFromText(const std::string& text);

/// What to add to a message on a text that is no number: something, if it has a decimal comma, as
/// much of the world writes it.
std::string commaHint(const std::string& text);

}  // namespace vdb_madf
