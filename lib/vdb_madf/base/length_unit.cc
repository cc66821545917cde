// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/base/length_unit.h"

#include <cmath>
#include <map>

#include "vdb_madf/base/detail/text.h"
#include "vdb_madf/base/lower_case.h"

namespace vdb_madf {

using detail::shortestDecimal;

std::string lengthIn(double unitsPerMetre, double metres) {
  const double value = metres * unitsPerMetre;
  for (const double candidate : {value, std::nextafter(value, 0.0), std::nextafter(value, 1e300)})
    if (candidate / unitsPerMetre == metres) {
      // 8.499999999999999 and 8.5 may both give 8.5e-6 back: the shorter is meant.
      const std::string text = detail::generalDecimal(candidate, 15);
      if (detail::leadingReal(text).value / unitsPerMetre == metres) return text;
      return shortestDecimal(candidate);
    }
  return shortestDecimal(value);
}

std::array<std::string, 3> lengthsIn(double unitsPerMetre, const std::array<double, 3>& metres) {
  return {lengthIn(unitsPerMetre, metres[0]), lengthIn(unitsPerMetre, metres[1]),
          lengthIn(unitsPerMetre, metres[2])};
}

std::optional<double> unitsPerMetre(const std::string& unit) {
  static const std::map<std::string, double> kUnits = {
      {"angstrom", 1e10},  {"\u00c5", 1e10},   {"\u212b", 1e10},  // the letter, and the sign
      {"nm", 1e9},         {"nanometer", 1e9}, {"nanometre", 1e9},
      {"um", 1e6},         {"micron", 1e6},    {"micrometer", 1e6},
      {"micrometre", 1e6}, {"\u00b5m", 1e6},  // micro sign, UTF-8
      {"\u03bcm", 1e6},                       // Greek mu, UTF-8
      {"\xb5m", 1e6},                         // micro sign, Latin-1
      {"\\u00b5m", 1e6},                      // as ImageJ escapes it
      {"\\u03bcm", 1e6},   {"mm", 1e3},        {"millimeter", 1e3},
      {"millimetre", 1e3}, {"cm", 1e2},        {"centimeter", 1e2},
      {"centimetre", 1e2}, {"m", 1},           {"meter", 1},
      {"metre", 1}};
  std::string name = lowerCase(detail::trimmed(unit));
  auto found = kUnits.find(name);
  if (found == kUnits.end() && name.size() > 2 && name.back() == 's') {
    name.pop_back();
    found = kUnits.find(name);
  }
  if (found == kUnits.end()) return std::nullopt;
  return found->second;
}

}  // namespace vdb_madf
