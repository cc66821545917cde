// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/base/detail/control_groups.h"

#include <algorithm>
#include <fstream>
#include <limits>
#include <optional>
#include <sstream>

namespace vdb_madf::detail {

namespace {

constexpr int64_t kNoLimit = std::numeric_limits<int64_t>::max();

/// The names of what a version of control groups says of memory.
struct GroupFiles {
  const char *limit, *used, *inactiveCache, *activeCache;
};
constexpr GroupFiles kVersion1{"memory.limit_in_bytes", "memory.usage_in_bytes",
                               "total_inactive_file", "total_active_file"};
constexpr GroupFiles kVersion2{"memory.max", "memory.current", "inactive_file", "active_file"};

std::optional<int64_t> numberIn(const std::string& path) {
  std::ifstream file(path);
  int64_t number = 0;
  if (!(file >> number)) return {};  // also "max"
  return number;
}

int64_t cacheIn(const std::string& path, const GroupFiles& files) {
  std::ifstream file(path);
  int64_t sum = 0, bytes = 0;
  for (std::string key; file >> key >> bytes;)
    if (key == files.inactiveCache || key == files.activeCache) sum += bytes;
  return sum;
}

/// What a group in a folder says.
using InGroup = int64_t(const std::string& folder, const GroupFiles& files);

int64_t limitOfGroup(const std::string& folder, const GroupFiles& files) {
  return numberIn(folder + files.limit).value_or(kNoLimit);
}

int64_t freeInGroup(const std::string& folder, const GroupFiles& files) {
  const auto limit = numberIn(folder + files.limit);
  if (!limit) return kNoLimit;
  const int64_t used = numberIn(folder + files.used).value_or(0),
                cache = cacheIn(folder + "memory.stat", files);
  return *limit - std::max<int64_t>(0, used - cache);
}

/// In a group and all above it; in a container the path may be one of outside, where only the
/// uppermost folder is there.
int64_t leastAlong(const std::string& mounted, std::string path, const GroupFiles& files,
                   InGroup& inGroup) {
  int64_t least = inGroup(mounted + "/", files);
  while (path.size() > 1) {
    least = std::min(least, inGroup(mounted + path + "/", files));
    path.resize(path.rfind('/'));
  }
  return least;
}

bool holdsMemory(const std::string& controllers) {
  return ("," + controllers + ",").find(",memory,") != std::string::npos;
}

int64_t leastOf(const std::string& groups, const std::string& mounted, InGroup& inGroup) {
  std::istringstream lines(groups);
  int64_t least = kNoLimit;
  for (std::string number, controllers, path; std::getline(lines, number, ':') &&
                                              std::getline(lines, controllers, ':') &&
                                              std::getline(lines, path);) {
    if (path.empty() || path[0] != '/') continue;
    if (controllers.empty())
      least = std::min(least, leastAlong(mounted, path, kVersion2, inGroup));
    else if (holdsMemory(controllers))
      least = std::min(least, leastAlong(mounted + "/memory", path, kVersion1, inGroup));
  }
  return least;
}

}  // namespace

int64_t freeInGroups(const std::string& groups, const std::string& mounted) {
  return leastOf(groups, mounted, freeInGroup);
}

int64_t limitOfGroups(const std::string& groups, const std::string& mounted) {
  return leastOf(groups, mounted, limitOfGroup);
}

}  // namespace vdb_madf::detail
