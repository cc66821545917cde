// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstdint>

#include "segment_summary.h"

namespace vdb_madf::tools {

/// What segmenting would take, found without doing it.
struct SegmentEstimate {
  int64_t voxels = 0, leaves = 0;
  int64_t memory = 0;  ///< bytes
  int64_t limit = 0;   ///< bytes that it may take; 0: not known
  int64_t slabs = 0;   ///< 0: as a whole
  double secondsRead = 0;
  int64_t scratch = 0;  ///< bytes on the disk that slabs take beside their labels, at most
};

/// Says it as `segment --dry-run` does, and as JSON.
void say(const SegmentArguments& o, const Common& common, const SegmentEstimate& estimate,
         JsonFile& jsonFile);

}  // namespace vdb_madf::tools
