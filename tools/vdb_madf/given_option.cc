// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "given_option.h"

#include <openvdb/Metadata.h>

#include <cstdint>
#include <utility>

#include "outputs.h"
#include "vdb_madf/files/read_text.h"
#include "vdb_madf/matching/track.h"

namespace vdb_madf::tools {

std::vector<GivenColumn> readGiven(const std::string& path, const Int32Grid& labels,
                                   Progress* progress) {
  constexpr uint64_t kMostBytes = uint64_t(1) << 30;
  if (path.empty()) return {};
  const bool isTracked = labels.getMetadata<openvdb::StringMetadata>(kTrackKey) != nullptr;
  GivenTable table =
      withFileName(path, [&] { return givenColumns(readText(path, kMostBytes), isTracked); });
  std::string leftOut;
  for (const std::string& name : table.leftOut)
    leftOut += (leftOut.empty() ? "'" : ", '") + name + "'";
  if (!leftOut.empty())
    progress->note(path +
                   ": left out is what has other cells than numbers, no name of its own, "
                   "or nothing: " +
                   leftOut);
  return std::move(table.columns);
}

}  // namespace vdb_madf::tools
