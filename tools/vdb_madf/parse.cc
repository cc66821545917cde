// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "parse.h"

#include <fmt/core.h>

#include <charconv>
#include <limits>
#include <optional>

#include "vdb_madf/base/errors.h"
#include "vdb_madf/base/limits.h"
#include "vdb_madf/base/lower_case.h"
#include "vdb_madf/base/size_text.h"
#include "vdb_madf/exports/measurement_files.h"
#include "wrong_usage.h"

namespace vdb_madf::tools {

namespace {

std::optional<int> parseInt(const std::string& text) {
  int value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

std::optional<Coord> parseCoord(const std::string& text, char separator) {
  const std::vector<std::string> parts = split(text, separator);
  if (parts.size() != 3) return std::nullopt;
  Coord coord;
  for (int axis = 0; axis < 3; ++axis) {
    const std::optional<int> value = parseInt(parts[size_t(axis)]);
    if (!value) return std::nullopt;
    coord[axis] = *value;
  }
  return coord;
}

/// Runs `parse` of the library, whose messages begin with the text.
template <typename Parse>
auto withOption(const std::string& option, const Parse& parse) -> decltype(parse()) {
  try {
    return parse();
  } catch (const InvalidInput& error) {
    throw WrongUsage(option + " " + error.what());
  }
}

}  // namespace

std::vector<std::string> split(const std::string& text, char separator) {
  std::vector<std::string> parts(1);
  for (const char c : text) {
    if (c == separator)
      parts.emplace_back();
    else
      parts.back() += c;
  }
  return parts;
}

double parseNumber(const std::string& text, const std::string& option) {
  return withOption(option, [&] { return numberFromText(text); });
}

std::optional<double> parseDensity(bool ice, const std::string& density) {
  if (ice && !density.empty()) throw WrongUsage("--ice is --density 917: give one of the two");
  if (ice) return kIceDensity;
  if (density.empty()) return std::nullopt;
  const double number = parseNumber(density, "--density");
  constexpr double kLeast = 10;
  if (!(number >= kLeast))
    throw WrongUsage("--density " + density + ": must be 10 or more, in kg/m3: ice has 917");
  return number;
}

Coord parseDims(const std::string& text, const std::string& option) {
  const std::optional<Coord> size = parseCoord(text, 'x');
  if (!size || size->x() < 1 || size->y() < 1 || size->z() < 1 || size->x() > kMaxImageSide ||
      size->y() > kMaxImageSide || size->z() > kMaxImageSide)
    throw WrongUsage(
        fmt::format("{} {}: write NXxNYxNZ, each from 1 to {}, for example 301x301x251", option,
                    text, kMaxImageSide));
  return *size;
}

CoordBBox parseBox(const std::string& text, const std::string& option) {
  const std::vector<std::string> corners = split(text, ':');
  if (corners.size() == 2) {
    const std::optional<Coord> lower = parseCoord(corners[0], ','),
                               upper = parseCoord(corners[1], ',');
    if (lower && upper) {
      const CoordBBox box(*lower, *upper);
      if (!box.empty() && CoordBBox(Coord(-kMaxImageSide), Coord(kMaxImageSide)).isInside(box))
        return box;
    }
  }
  throw WrongUsage(
      fmt::format("{} {}: write x0,y0,z0:x1,y1,z1 (inclusive, x0 <= x1 ..., within +-{})", option,
                  text, kMaxImageSide));
}

Coord parseShift(const std::string& text, const std::string& option) {
  const std::optional<Coord> shift = parseCoord(text, ',');
  if (!shift || !CoordBBox(Coord(-kMaxExtent), Coord(kMaxExtent)).isInside(*shift))
    throw WrongUsage(fmt::format("{} {}: write X,Y,Z, whole voxels within +-{}, for example 3,-2,0",
                                 option, text, kMaxExtent));
  return *shift;
}

RegionOptions parseRoi(const std::string& text) {
  RegionOptions region;
  const std::vector<std::string> parts = split(text, ':');
  if (parts[0] != "cylinder") {
    region.mask = text;
    return region;
  }
  CylinderOptions cylinder;
  const auto require = [&](bool holds, const std::string& what) {
    if (!holds)
      throw WrongUsage("--roi " + text + ": " + what +
                       "; write cylinder[:AXIS[:CX,CY[:RADIUS]]], for example cylinder:z, "
                       "cylinder:z:150,150:149, or the file of a mask");
  };
  require(parts.size() <= 4, "too many parts");
  if (parts.size() > 1) {
    const std::string axis = lowerCase(parts[1]);
    require(axis == "x" || axis == "y" || axis == "z", "the axis must be x, y or z");
    cylinder.axis = axis[0] - 'x';
  }
  if (parts.size() > 2 && !parts[2].empty()) {
    const std::vector<std::string> center = split(parts[2], ',');
    require(center.size() == 2, "the center is two numbers");
    cylinder.center = {parseNumber(center[0], "--roi"), parseNumber(center[1], "--roi")};
  }
  if (parts.size() > 3) {
    cylinder.radius = parseNumber(parts[3], "--roi");
    require(*cylinder.radius > 0, "the radius must be above 0");
  }
  region.cylinder = cylinder;
  return region;
}

VoxelSize parseVoxelSize(const std::string& text, const std::string& option) {
  return withOption(option, [&] { return voxelSizeFromText(text); });
}

int64_t parseCount(const std::string& text, const std::string& option) {
  int64_t count = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), count);
  if (error != std::errc() || end != text.data() + text.size() || count < 0)
    throw WrongUsage(option + " " + text + ": must be a whole number, 0 or more");
  return count;
}

std::vector<int32_t> parseGrains(const std::string& text, const std::string& option) {
  std::vector<int32_t> grains;
  if (text.empty()) return grains;
  for (const std::string& part : split(text, ',')) {
    const int64_t grain = parseCount(part, option);
    if (grain < 1 || grain > std::numeric_limits<int32_t>::max())
      throw WrongUsage(option + " " + part + ": grains have the numbers 1 and more");
    grains.push_back(int32_t(grain));
  }
  return grains;
}

Boundary parseBoundary(const std::string& boundary) {
  return boundary == "open"     ? Boundary::open
         : boundary == "closed" ? Boundary::closed
                                : Boundary::automatic;
}

int64_t parseMemory(const std::string& text) {
  return withOption("--max-memory", [&] { return bytesFromText(text); });
}

}  // namespace vdb_madf::tools
