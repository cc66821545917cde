// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "vdb_madf/base/length_unit.h"
#include "vdb_madf/base/voxel_size.h"
#include "vdb_madf/files/detail/input_file.h"
#include "vdb_madf/images/image.h"

namespace vdb_madf::detail {

// What the readers of images check in headers.

/// `name` as seen from the folder of the file `header`.
std::string besideHeader(const std::string& header, const std::string& name);
/// The one file that holds the samples of a header. @throw IoError for a list or pattern of files
std::unique_ptr<InputFile> openDataFile(const std::string& header, const std::string& name);

/// The edges of a voxel from the spacing along x, y and z. Without a unit there is no physical
/// size, but voxels that are not cubes are an error: they would be taken for cubes.
/// @throw IoError if a spacing is no plausible length.
std::optional<VoxelSize> checkedVoxelSize(const std::string& path,
                                          const std::array<double, 3>& spacing,
                                          std::optional<double> unitsPerMetre);

/// Sets what is known of the voxels: their size, or without a unit their proportions.
/// @throw IoError if a spacing is no plausible length.
void setSpacing(ImageInfo& info, const std::string& path, const std::array<double, 3>& spacing,
                std::optional<double> unitsPerMetre);

/// Is a place along an axis, but for rounding, a voxel of this edge or more from the origin
/// (ImageInfo::isPlaced)?
bool isVoxelAway(double place, double edge);

/// Names of axes, as far as a file gives them, the last of which is the fastest.
/// @throw IoError if one of the last three is called x, y or z and is not where that one is read
void checkAxisNames(const std::string& path, const std::vector<std::string>& names);

/// @throw IoError unless each size is in 1 .. kMaxImageSide.
ImageSize checkedSize(const std::string& path, const std::vector<int64_t>& size);

inline uint64_t sliceBytes(const ImageInfo& info) {
  return uint64_t(info.size.x) * uint64_t(info.size.y) * sampleSize(info.type);
}
inline uint64_t imageBytes(const ImageInfo& info) {  // < 2^64: sizes are at most 2^20
  return sliceBytes(info) * uint64_t(info.size.z);
}
/// @throw InvalidInput unless the slices exist.
void checkSlices(const std::string& path, const ImageInfo& info, int first, int count);

}  // namespace vdb_madf::detail
