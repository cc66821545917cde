// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/images/detail/header_checks.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "vdb_madf/base/detail/text.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/base/length_unit.h"
#include "vdb_madf/base/limits.h"
#include "vdb_madf/base/lower_case.h"

namespace vdb_madf::detail {

namespace {

/// Lengths beyond these are no voxels, and break transforms: an atom, a kilometer.
constexpr double kMinVoxelMeters = 1e-10, kMaxVoxelMeters = 1e3;

}  // namespace

std::string besideHeader(const std::string& header, const std::string& name) {
  return (std::filesystem::path(header).parent_path() / name).string();
}

std::unique_ptr<InputFile> openDataFile(const std::string& header, const std::string& name) {
  if (name.compare(0, 4, "LIST") == 0 || name.find('%') != std::string::npos)
    throw IoError(header + ": its data are spread over several files; write them into one");
  return std::make_unique<InputFile>(header, besideHeader(header, name));
}

std::optional<VoxelSize> checkedVoxelSize(const std::string& path,
                                          const std::array<double, 3>& spacing,
                                          std::optional<double> unitsPerMetre) {
  const bool positive = std::all_of(spacing.begin(), spacing.end(),
                                    [](double s) { return std::isfinite(s) && s > 0; });
  const std::string text = shortestDecimal(spacing[0]) + ", " + shortestDecimal(spacing[1]) + ", " +
                           shortestDecimal(spacing[2]);
  if (!positive) throw IoError(path + ": unusable spacing " + text + ": correct the header");
  if (!unitsPerMetre && areEdgesOfCube(spacing)) return std::nullopt;
  if (!unitsPerMetre)
    throw IoError(path + ": unequal spacing " + text + " without a unit: add it to the header");
  std::array<double, 3> edges = spacing;
  for (double& edge : edges) {
    edge /= *unitsPerMetre;
    if (edge < kMinVoxelMeters || edge > kMaxVoxelMeters)
      throw IoError(path + ": a voxel size of " + shortestDecimal(edge) +
                    " m is not plausible: correct the header");
  }
  return VoxelSize(edges);
}

void setSpacing(ImageInfo& info, const std::string& path, const std::array<double, 3>& spacing,
                std::optional<double> unitsPerMetre) {
  const auto [min, max] = std::minmax_element(spacing.begin(), spacing.end());
  if (unitsPerMetre || !(*min > 0 && std::isfinite(*max)) || areEdgesOfCube(spacing))
    info.voxelSize = checkedVoxelSize(path, spacing, unitsPerMetre);
  else
    info.proportions = spacing;
}

bool isVoxelAway(double place, double edge) {
  constexpr double kNearlyOne = 1 - 1e-6;
  return std::abs(place) >= edge * kNearlyOne;
}

ImageSize checkedSize(const std::string& path, const std::vector<int64_t>& size) {
  if (size.size() != 3)
    throw IoError(path + ": has " + std::to_string(size.size()) +
                  " dimensions; only 3-D images can be read");
  for (const int64_t n : size)
    if (n < 1 || n > kMaxImageSide)
      throw IoError(path + ": size " + std::to_string(size[0]) + " x " + std::to_string(size[1]) +
                    " x " + std::to_string(size[2]) + " is not within 1 .. " +
                    std::to_string(kMaxImageSide) + " a side");
  return {int(size[0]), int(size[1]), int(size[2])};
}

void checkAxisNames(const std::string& path, const std::vector<std::string>& names) {
  constexpr char kUsual[] = "zyx";
  if (names.size() < 3) return;
  const std::vector<std::string> last(names.end() - 3, names.end());
  bool isUsual = true;
  for (size_t i = 0; i < 3; ++i) {
    const std::string name = lowerCase(last[i]);
    for (const char axis : {'x', 'y', 'z'})
      if (name == std::string(1, axis)) isUsual = isUsual && axis == kUsual[i];
  }
  if (isUsual) return;
  throw IoError(path + ": its axes are called " + inQuotes(last[0]) + ", " + inQuotes(last[1]) +
                ", " + inQuotes(last[2]) +
                ", and z, y, x is the order that is read: save it in that one");
}

void checkSlices(const std::string& path, const ImageInfo& info, int first, int count) {
  if (first < 0 || count < 0 || count > info.size.z || first > info.size.z - count)
    throw InvalidInput(path + ": has slices 0 .. " + std::to_string(info.size.z - 1) + ", not " +
                       std::to_string(first) + " and " + std::to_string(count) + " in all");
}

}  // namespace vdb_madf::detail
