// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "memory_limit.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>

#include "command.h"

namespace vdb_madf::tools {

namespace {

/// A control group's number of bytes; 0 if there is none ("max").
int64_t groupBytes(const char* path) {
  std::ifstream file(path);
  int64_t bytes = 0;
  return file >> bytes ? bytes : 0;
}

}  // namespace

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

int64_t availableMemory() {
  int64_t available = 0;
  std::ifstream file("/proc/meminfo");
  for (std::string key, rest; file >> key;) {
    if (key == "MemAvailable:" && file >> available) {
      available *= 1024;
      break;
    }
    std::getline(file, rest);
  }
  if (const int64_t limit = groupBytes("/sys/fs/cgroup/memory.max"))
    available = std::min(available,
                         std::max<int64_t>(1, limit - groupBytes("/sys/fs/cgroup/memory.current")));
  return available;
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
