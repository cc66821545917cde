// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include <filesystem>
#include <limits>
#include <string>

#include "support/catch.h"
#include "support/files.h"
#include "vdb_madf/base/detail/control_groups.h"

using namespace vdb_madf;
using namespace vdb_madf::test;

namespace {

void writeGroup(const std::string& folder, const std::string& file, const std::string& text) {
  std::filesystem::create_directories(folder);
  writeFile(folder + "/" + file, text + "\n");
}

}  // namespace

TEST_CASE("memory_limits: control groups of the second version", "[memory_limits]") {
  const ScratchFolder folder;
  const std::string root = folder / "groups", job = root + "/job", step = job + "/step";
  const std::string groups = "0::/job/step\n";
  CHECK(detail::freeInGroups(groups, root) == std::numeric_limits<int64_t>::max());
  writeGroup(step, "memory.max", "max");
  CHECK(detail::freeInGroups(groups, root) == std::numeric_limits<int64_t>::max());
  writeGroup(job, "memory.max", "1000");
  writeGroup(job, "memory.current", "700");
  CHECK(detail::freeInGroups(groups, root) == 300);
  writeGroup(job, "memory.stat", "anon 50\nactive_file 20\ninactive_file 130\nslab 9");
  CHECK(detail::freeInGroups(groups, root) == 450);  // the cache of files is given back
  writeGroup(step, "memory.max", "400");
  CHECK(detail::freeInGroups(groups, root) == 400);
  writeGroup(root, "memory.max", "30");  // as in a container, whose group is the uppermost
  CHECK(detail::freeInGroups("0::/\n", root) == 30);
  CHECK(detail::freeInGroups("", root) == std::numeric_limits<int64_t>::max());
}

TEST_CASE("memory_limits: control groups of the first version", "[memory_limits]") {
  const ScratchFolder folder;
  const std::string root = folder / "groups", job = root + "/memory/slurm/job:7";
  const std::string groups = "9:cpuset:/\n4:memory,hugetlb:/slurm/job:7\n1:name=systemd:/\n0::/\n";
  writeGroup(root + "/memory", "memory.limit_in_bytes", "9223372036854771712");
  writeGroup(root + "/memory", "memory.usage_in_bytes", "5000");
  CHECK(detail::freeInGroups(groups, root) > int64_t(1) << 62);
  writeGroup(job, "memory.limit_in_bytes", "1000");
  writeGroup(job, "memory.usage_in_bytes", "900");
  writeGroup(job, "memory.stat", "inactive_file 1\ntotal_inactive_file 300\ntotal_active_file 50");
  CHECK(detail::freeInGroups(groups, root) == 450);
}
