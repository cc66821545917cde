// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <array>
#include <charconv>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "vdb_madf/image_file.h"

namespace vdb_madf::detail {

// What the readers of text headers share.

std::string trimmed(const std::string& text);
std::string lowerCase(std::string text);
/// Text of a file in quotes for a message: printable, one line, clipped.
std::string quoted(const std::string& text);
/// All of the text as numbers between white space, independent of the locale.
std::optional<std::vector<int64_t>> integers(const std::string& text);
std::optional<std::vector<double>> reals(const std::string& text);
/// The shortest decimal that reads back as the same number.
template <typename T>
std::string shortestDecimal(T value) {
  char text[64];
  return {text, std::to_chars(text, text + sizeof text, value).ptr};
}
/// A length as a decimal in another unit, such that the decimal / unitsPerMetre gives back `metres`
/// to the last bit (or nearly, where no double does).
std::string lengthIn(double unitsPerMetre, double metres);

/// `name` as seen from the folder of the file `header`.
std::string besideHeader(const std::string& header, const std::string& name);

/// How many of the unit make a metre: "um", "micron", "µm" in its many spellings, "mm" ...
std::optional<double> unitsPerMetre(const std::string& unit);

/// The edge of a cubic voxel; the first of the three is the one returned. Without a unit there is
/// no physical size, but voxels that are not cubes are still an error.
/// @throw IoError if the spacing differs by more than 0.1 % or is no plausible length.
std::optional<VoxelSize> cubicVoxelSize(const std::string& path,
                                        const std::array<double, 3>& spacing,
                                        std::optional<double> unitsPerMetre);

/// @throw IoError unless each size is in 1 .. 2^20.
Coord checkedSize(const std::string& path, const std::vector<int64_t>& size);

inline uint64_t sliceBytes(const ImageInfo& info) {
  return uint64_t(info.size.x()) * uint64_t(info.size.y()) * sampleSize(info.type);
}
inline uint64_t imageBytes(const ImageInfo& info) {  // < 2^64: sizes are at most 2^20
  return sliceBytes(info) * uint64_t(info.size.z());
}
/// @throw InvalidInput unless the slices exist.
void checkSlices(const std::string& path, const ImageInfo& info, int first, int count);

}  // namespace vdb_madf::detail
