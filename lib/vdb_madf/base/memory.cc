// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/base/memory.h"
#include "vdb_madf/base/detail/control_groups.h"
#include "vdb_madf/base/detail/text.h"
#include "vdb_madf/base/errors.h"

#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <limits>
#include <string>
#include <utility>

namespace vdb_madf {

namespace {

std::string textOf(const char* path) {
  std::ifstream file(path);
  return {std::istreambuf_iterator<char>(file), {}};
}

/// What this process has mapped, bytes: all of it, and what it may write to.
struct MappedMemory {
  int64_t all = 0, data = 0;
};

MappedMemory mappedMemory() {
  std::ifstream file("/proc/self/statm");
  int64_t pages[6] = {};  // the first: all, the last: data and stack
  for (int64_t& number : pages) file >> number;
  const int64_t page = ::sysconf(_SC_PAGESIZE);
  return {pages[0] * page, pages[5] * page};
}

/// What this process may still map: its own limits (`ulimit -v`, `ulimit -d`) without what it has.
int64_t freeInProcess() {
  const MappedMemory mapped = mappedMemory();
  int64_t least = std::numeric_limits<int64_t>::max();
  for (const auto& [resource, used] :
       {std::pair(RLIMIT_AS, mapped.all), {RLIMIT_DATA, mapped.data}}) {
    struct rlimit limit {};
    if (::getrlimit(resource, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY)
      least = std::min(least, int64_t(limit.rlim_cur) - used);
  }
  return least;
}

}  // namespace

int64_t peakMemory() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return int64_t(usage.ru_maxrss) * 1024;
}

int64_t pageFaults() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return usage.ru_minflt;
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
  if (available == 0) return 0;
  const int64_t allowed = std::min(
      freeInProcess(), detail::freeInGroups(textOf("/proc/self/cgroup"), "/sys/fs/cgroup"));
  return std::max<int64_t>(1, std::min(available, allowed));
}

int64_t memoryLimit() {
  int64_t bytes = detail::limitOfGroups(textOf("/proc/self/cgroup"), "/sys/fs/cgroup");
  const long pages = ::sysconf(_SC_PHYS_PAGES), pageSize = ::sysconf(_SC_PAGESIZE);
  if (pages > 0 && pageSize > 0) bytes = std::min(bytes, int64_t(pages) * pageSize);
  for (const auto resource : {RLIMIT_AS, RLIMIT_DATA}) {
    struct rlimit limit {};
    if (::getrlimit(resource, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY)
      bytes = std::min(bytes, int64_t(limit.rlim_cur));
  }
  return bytes;
}

void limitMemory(int64_t bytes) {
  constexpr int64_t kLittle = int64_t(16) << 20;
  const int64_t used = mappedMemory().data;
  if (bytes < used + kLittle)
    throw InvalidInput(readableBytes(bytes) + " of memory are not enough: it takes " +
                       readableBytes(used + kLittle) + " to begin with");
  struct rlimit limit {};
  if (::getrlimit(RLIMIT_DATA, &limit) != 0) return;
  limit.rlim_cur = std::min<rlim_t>(limit.rlim_cur, rlim_t(bytes));
  ::setrlimit(RLIMIT_DATA, &limit);
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
