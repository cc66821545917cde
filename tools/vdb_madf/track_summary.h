// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "input_options.h"
#include "json_file.h"
#include "vdb_madf/matching/track.h"

namespace vdb_madf::tools {

/// What is typed for track.
struct TrackArguments {
  InputOptions before, after;
  std::vector<std::string> more;  // of a series: further scans, and the folder
  TrackOptions track;
  std::string out, shift, motion, json, grains, links, bonds, phi, network,
      minFaces = "1", sureFaces = std::to_string(track.sureFaces);
};

/// What --json writes.
Json summaryOf(const TrackArguments& o, const Tracks& t);
/// Says the same, by what summaryOf() gives.
void print(const TrackArguments& o, const Tracks& t, const Json& json);

}  // namespace vdb_madf::tools
