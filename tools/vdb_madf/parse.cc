// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "parse.h"

#include <charconv>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <optional>

#include "vdb_madf/base/limits.h"
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
    throw WrongUsage(option + " " + text + ": not a finite number");
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

CoordBBox parseDomain(const std::string& text) {
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
  throw WrongUsage("--domain " + text +
                   ": write x0,y0,z0:x1,y1,z1 (inclusive, x0 <= x1 ..., within +-" +
                   std::to_string(kMaxImageSide) + ")");
}

VoxelSize parseVoxelSize(const std::string& text) {
  for (const auto& [unit, metres] :
       {std::pair<const char*, double>{"nm", 1e-9}, {"um", 1e-6}, {"mm", 1e-3}, {"m", 1.0}}) {
    const size_t length = std::strlen(unit);
    if (text.size() <= length || text.compare(text.size() - length, length, unit) != 0) continue;
    const std::string number = text.substr(0, text.size() - length);
    const double value = parseNumber(number, "--voxel-size");
    // Dividing by a power of ten keeps decimal inputs exact to the last bit.
    const double size = metres == 1.0 ? value : value / std::round(1 / metres);
    if (size >= 1e-10 && size <= 1) return {size};
    throw WrongUsage("--voxel-size " + text + ": must lie between 0.1nm and 1m");
  }
  throw WrongUsage("--voxel-size " + text + ": give a unit (nm, um, mm or m), for example 8.5um");
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
  std::string unit = end;
  double factor = 1;
  if (!unit.empty() && unit != "B") {
    const size_t power = std::string("KMGT").find(char(std::toupper(unit[0]))) + 1;
    unit.erase(0, 1);
    if (unit.empty() || unit == "iB")
      factor = std::pow(1024.0, double(power));
    else if (unit == "B")
      factor = std::pow(1000.0, double(power));
    else
      factor = 0;
    if (power == 0) factor = 0;
  }
  const double bytes = number * factor;
  if (end == text.c_str() || !(bytes >= 1) || !(bytes < 9e18))
    throw WrongUsage("--max-memory " + text + ": give a size such as 12GiB or 500M");
  return int64_t(bytes);
}

std::string readableBytes(int64_t bytes) {
  const char* const units[] = {"bytes", "KiB", "MiB", "GiB", "TiB"};
  double number = double(bytes);
  size_t unit = 0;
  for (; number >= 1024 && unit < 4; ++unit) number /= 1024;
  char text[32];
  std::snprintf(text, sizeof text, unit == 0 ? "%.0f %s" : "%.3g %s", number, units[unit]);
  return text;
}

}  // namespace vdb_madf::tools
