// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstdint>
#include <string>

namespace vdb_madf::detail {

/// Bytes that are free in the control groups of a process, of both versions, and in those above
/// them: a group's limit without what it uses, but for the cache of files, which is given back.
/// The largest number where there is no limit.
/// @param groups what /proc/self/cgroup says
/// @param mounted /sys/fs/cgroup
int64_t freeInGroups(const std::string& groups, const std::string& mounted);

/// The least limit of these groups, whatever they use; parameters as above.
int64_t limitOfGroups(const std::string& groups, const std::string& mounted);

}  // namespace vdb_madf::detail
