// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/base/size_text.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "vdb_madf/base/detail/text.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/base/length_unit.h"
#include "vdb_madf/base/lower_case.h"

namespace vdb_madf {

namespace {

/// The parts between the letters x; at least one.
std::vector<std::string> edgesOf(const std::string& text) {
  std::vector<std::string> edges(1);
  for (const char c : text) {
    if (c == 'x')
      edges.emplace_back();
    else
      edges.back() += c;
  }
  return edges;
}

}  // namespace

VoxelSize voxelSizeFromText(const std::string& text) {
  const std::vector<std::string> parts = edgesOf(text);
  if (parts.size() != 1 && parts.size() != 3)
    throw InvalidInput(text + ": write one edge or three, for example 8.5um or 0.5x0.5x1.2um");
  std::vector<double> edges;
  std::string unit;
  for (auto part = parts.rbegin(); part != parts.rend(); ++part) {  // the last has the unit of all
    const detail::LeadingReal number = detail::leadingReal(*part);
    if (number.length == 0 || !std::isfinite(number.value))
      throw InvalidInput(text + ": not a finite number");
    const std::string rest = part->substr(number.length);
    if (rest.find_first_not_of(' ') != std::string::npos) unit = rest;
    const auto perMetre = unitsPerMetre(unit);
    if (!perMetre)
      throw InvalidInput(text + (rest[0] == ','
                                     ? commaHint(text)
                                     : ": give a unit (nm, um, mm, cm or m), for example 8.5um"));
    // Dividing by a power of ten keeps decimal inputs exact to the last bit.
    edges.push_back(number.value / *perMetre);
    if (!(edges.back() >= 1e-10 && edges.back() <= 1))
      throw InvalidInput(text + ": must lie between 0.1nm and 1m");
  }
  return edges.size() == 1 ? VoxelSize(edges[0]) : VoxelSize({edges[2], edges[1], edges[0]});
}

int64_t bytesFromText(const std::string& text) {
  const detail::LeadingReal number = detail::leadingReal(text);
  std::string unit = lowerCase(text.substr(number.length));
  unit.erase(std::remove(unit.begin(), unit.end(), ' '), unit.end());
  double factor = unit == "b" ? 1 : 0;
  const size_t power = unit.empty() ? 0 : std::string("kmgt").find(unit[0]) + 1;
  if (power > 0 && (unit.size() == 1 || unit.substr(1) == "ib"))
    factor = std::pow(1024.0, double(power));
  else if (power > 0 && unit.substr(1) == "b")
    factor = std::pow(1000.0, double(power));
  const double bytes = number.value * factor;
  if (number.length == 0 || !(bytes >= 1) || !(bytes < 9e18))
    throw InvalidInput(text + ": give a size with its unit, such as 12GiB or 500M" +
                       commaHint(text));
  return int64_t(bytes);
}

double numberFromText(const std::string& text) {
  const detail::LeadingReal number = detail::leadingReal(text);
  if (number.length != text.size() || text.empty() || !std::isfinite(number.value))
    throw InvalidInput(text + ": not a finite number" + commaHint(text));
  return number.value;
}

std::string commaHint(const std::string& text) {
  return text.find(',') == std::string::npos ? "" : ": write a point, not a comma, before decimals";
}

}  // namespace vdb_madf
