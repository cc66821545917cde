// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <array>
#include <optional>
#include <string>

#include "vdb_madf/base/interrupter.h"
#include "vdb_madf/base/voxel_size.h"
#include "vdb_madf/images/image.h"

namespace vdb_madf {

/// Copies an image slab by slab into another format and sample type; \p voxelSize replaces its own.
/// @param origin as in createImage()
/// @throw InvalidInput if a value does not fit the sample type, naming the value; IoError;
/// Interrupted.
void copyImage(const std::string& path, ImageReader& image, SampleType type,
               const std::optional<VoxelSize>& voxelSize = std::nullopt,
               Interrupter* interrupter = nullptr, const std::array<double, 3>& origin = {});

}  // namespace vdb_madf
