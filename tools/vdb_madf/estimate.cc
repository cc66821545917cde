// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "estimate.h"

#include <cstdio>

#include "vdb_madf/base/memory.h"

namespace vdb_madf::tools {

void say(const SegmentArguments& o, const Common& common, const SegmentEstimate& estimate,
         JsonFile& jsonFile) {
  const bool fits = estimate.limit == 0 || estimate.memory <= estimate.limit;
  Json json;
  json["input"] = o.input.path;
  json["object_voxels"] = estimate.voxels;
  json["leaves"] = estimate.leaves;
  json["estimated_memory_bytes"] = estimate.memory;
  json["memory_limit_bytes"] = estimate.limit;
  if (estimate.slabs > 0) {
    json["slab_count"] = estimate.slabs;
    json["estimated_scratch_bytes"] = estimate.scratch;
  }
  json["seconds_read"] = estimate.secondsRead;
  json["fits"] = fits;
  addNotes(json, *common.progress);
  jsonFile.write(json);
  if (common.quiet || jsonFile.isStandardOutput()) return;
  std::printf("%s: %lld object voxels in %lld leaf nodes\n", o.input.path.c_str(),
              (long long)estimate.voxels, (long long)estimate.leaves);
  if (estimate.slabs > 0) {
    std::printf("  slabs            %lld\n", (long long)estimate.slabs);
    std::printf("  scratch          up to some %s (%lld bytes) on the disk\n",
                readableBytes(estimate.scratch).c_str(), (long long)estimate.scratch);
  }
  std::printf("  memory           about %s (%lld bytes) to segment it\n",
              readableBytes(estimate.memory).c_str(), (long long)estimate.memory);
  std::printf("  limit            %s: %s\n",
              estimate.limit > 0 ? readableBytes(estimate.limit).c_str() : "not known",
              fits ? "it fits" : "it does not fit");
}

}  // namespace vdb_madf::tools
