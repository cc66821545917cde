// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstddef>

namespace vdb_madf {

/// 32-bit voxel ids (leaf * 512 + offset) end here: 8,388,607 leaves.
constexpr size_t kMaxLeaves = 0xffffffffu / 512;
/// Voxels a side. Squared distances fit in 32 bits up to here: 3 n^2 < 2^31.
constexpr int kMaxExtent = 26754;
/// Largest |coordinate| of an object voxel.
constexpr int kMaxCoordinate = (1 << 30) - 1;
/// Voxels a side of an image, and the largest |coordinate| of a volume that is read: larger numbers
/// in a header are damage.
constexpr int kMaxImageSide = 1 << 20;
/// Edges that differ by more than this factor are not those of a cube.
constexpr double kMaxEdgeRatio = 1.001;

}  // namespace vdb_madf
