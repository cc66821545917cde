// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "memory_limit.h"

#include <cmath>
#include <cstdio>
#include <cstdlib>

#include "command.h"

namespace vdb_madf::tools {

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
