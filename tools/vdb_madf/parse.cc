// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "parse.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <optional>

#include "vdb_madf/base/length_unit.h"
#include "vdb_madf/base/limits.h"
#include "vdb_madf/base/lower_case.h"
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

/// For a decimal comma, as much of the world writes it.
std::string commaHint(const std::string& text) {
  return text.find(',') == std::string::npos ? "" : ": write a point, not a comma, before decimals";
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
  char* end = nullptr;
  const double value = std::strtod(text.c_str(), &end);
  if (text.empty() || *end != '\0' || !std::isfinite(value))
    throw WrongUsage(option + " " + text + ": not a finite number" + commaHint(text));
  return value;
}

Coord parseDims(const std::string& text, const std::string& option) {
  const std::optional<Coord> size = parseCoord(text, 'x');
  if (!size || size->x() < 1 || size->y() < 1 || size->z() < 1 || size->x() > kMaxImageSide ||
      size->y() > kMaxImageSide || size->z() > kMaxImageSide)
    throw WrongUsage(option + " " + text + ": write NXxNYxNZ, each from 1 to " +
                     std::to_string(kMaxImageSide) + ", for example 301x301x251");
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
  throw WrongUsage(option + " " + text +
                   ": write x0,y0,z0:x1,y1,z1 (inclusive, x0 <= x1 ..., within +-" +
                   std::to_string(kMaxImageSide) + ")");
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
  const std::string given = option + " " + text;
  const std::vector<std::string> parts = split(text, 'x');
  if (parts.size() != 1 && parts.size() != 3)
    throw WrongUsage(given + ": write one edge or three, for example 8.5um or 0.5x0.5x1.2um");
  std::vector<double> edges;
  std::string unit;
  for (auto part = parts.rbegin(); part != parts.rend(); ++part) {  // the last has the unit of all
    char* end = nullptr;
    const double value = std::strtod(part->c_str(), &end);
    if (end == part->c_str() || !std::isfinite(value))
      throw WrongUsage(given + ": not a finite number");
    const std::string rest = end;
    if (rest.find_first_not_of(' ') != std::string::npos) unit = rest;
    const auto perMetre = unitsPerMetre(unit);
    if (!perMetre)
      throw WrongUsage(given + (rest[0] == ','
                                    ? commaHint(text)
                                    : ": give a unit (nm, um, mm or m), for example 8.5um"));
    // Dividing by a power of ten keeps decimal inputs exact to the last bit.
    edges.push_back(value / *perMetre);
    if (!(edges.back() >= 1e-10 && edges.back() <= 1))
      throw WrongUsage(given + ": must lie between 0.1nm and 1m");
  }
  return edges.size() == 1 ? VoxelSize(edges[0]) : VoxelSize({edges[2], edges[1], edges[0]});
}

int64_t parseCount(const std::string& text, const std::string& option) {
  int64_t count = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), count);
  if (error != std::errc() || end != text.data() + text.size() || count < 0)
    throw WrongUsage(option + " " + text + ": must be a whole number, 0 or more");
  return count;
}

Boundary parseBoundary(const std::string& boundary) {
  return boundary == "open"     ? Boundary::open
         : boundary == "closed" ? Boundary::closed
                                : Boundary::automatic;
}

int64_t parseMemory(const std::string& text) {
  char* end = nullptr;
  const double number = std::strtod(text.c_str(), &end);
  std::string unit = lowerCase(end);
  unit.erase(std::remove(unit.begin(), unit.end(), ' '), unit.end());
  double factor = unit == "b" ? 1 : 0;
  const size_t power = unit.empty() ? 0 : std::string("kmgt").find(unit[0]) + 1;
  if (power > 0 && (unit.size() == 1 || unit.substr(1) == "ib"))
    factor = std::pow(1024.0, double(power));
  else if (power > 0 && unit.substr(1) == "b")
    factor = std::pow(1000.0, double(power));
  const double bytes = number * factor;
  if (end == text.c_str() || !(bytes >= 1) || !(bytes < 9e18))
    throw WrongUsage("--max-memory " + text + ": give a size with its unit, such as 12GiB or 500M" +
                     commaHint(text));
  return int64_t(bytes);
}

}  // namespace vdb_madf::tools
