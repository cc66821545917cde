// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/base/memory.h"
#include "vdb_madf/base/detail/text.h"

#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <limits>
#include <string>

namespace vdb_madf {

namespace {

/// A control group's number of bytes; 0 if there is none ("max").
int64_t groupBytes(const char* path) {
  std::ifstream file(path);
  int64_t bytes = 0;
  return file >> bytes ? bytes : 0;
}

}  // namespace

int64_t peakMemory() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return int64_t(usage.ru_maxrss) * 1024;
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

int64_t memoryLimit() {
  int64_t bytes = std::numeric_limits<int64_t>::max();
  const long pages = ::sysconf(_SC_PHYS_PAGES), pageSize = ::sysconf(_SC_PAGESIZE);
  if (pages > 0 && pageSize > 0) bytes = int64_t(pages) * pageSize;
  for (const auto resource : {RLIMIT_AS, RLIMIT_DATA}) {
    struct rlimit limit {};
    if (::getrlimit(resource, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY)
      bytes = std::min(bytes, int64_t(limit.rlim_cur));
  }
  return bytes;
}

std::string readableBytes(int64_t bytes) {
  const char* const units[] = {"bytes", "KiB", "MiB", "GiB", "TiB"};
  double number = double(bytes);
  size_t unit = 0;
  for (; number >= 1024 && unit < 4; ++unit) number /= 1024;
  const bool isWhole = unit == 0 || number >= 100;
  return (isWhole ? detail::fixedDecimal(number, 0) : detail::generalDecimal(number, 3)) + " " +
         units[unit];
}

}  // namespace vdb_madf
