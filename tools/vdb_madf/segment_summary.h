// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <chrono>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "command.h"
#include "input_options.h"
#include "json_file.h"
#include "merge_options.h"
#include "vdb_madf/measure/grain_sizes.h"
#include "vdb_madf/segmentation/segment.h"
#include "vdb_madf/slabs/segment_slabs.h"

namespace vdb_madf::tools {

/// What was typed after `segment`, and what it means.
struct SegmentArguments {
  InputOptions input;
  std::string out, gamma = "0", boundary = "auto", keep, json, maxMemory, tables, unit;
  std::string fillHoles, tidy;
  MergeArguments merge;
  bool paper = false, dryRun = false;
  bool necks = false;  ///< with tables: of the gray scan
  int slabHeight = 0;  ///< 0: as memory allows
  std::string scratch;
  bool resume = false;
  bool autoSlabs = false;   ///< work in slabs if need be, and make one file of them
  std::string fileOfSlabs;  ///< that file, where `out` are the slabs
  SegmentOptions segment;

  const std::string& result() const { return fileOfSlabs.empty() ? out : fileOfSlabs; }
};

using Clock = std::chrono::steady_clock;
inline double secondsSince(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

struct SegmentTiming {
  double read = 0, measure = 0, write = 0, total = 0;
};

/// What is said of a segmentation, by the lines that are printed and by the JSON.
struct SegmentSummary : SegmentationRecord {
  GrainSizes sizes;
  std::optional<LabelFlaws> flaws;  ///< not counted in slabs
  std::optional<StableStrictness> stable;
  std::optional<VoxelSize> voxelSize;
  std::string objectSteps;  ///< from a gray image
  std::optional<double> threshold;
  int threads = 0;
  std::vector<std::pair<std::string, double>> seconds;  ///< of each part of the work, then "total"
  std::vector<std::pair<std::string, int64_t>> peakBytesUntil;  ///< the end of each stage
  std::vector<std::pair<std::string, int64_t>> pageFaults;      ///< of each stage, then "total"
  int64_t peakBytes = 0;
  std::vector<std::string> hints;  ///< what to turn if the grains look wrong

  std::optional<double> porosity() const;
};

SegmentSummary summarize(const SegmentArguments& o, const Common& common, const Segmentation& s,
                         const SegmentTiming& timing);
/// \p object: its metadata
SegmentSummary summarize(const SegmentArguments& o, const Common& common, const SlabSegmentation& s,
                         const openvdb::GridBase& object, const SegmentTiming& timing);
Json toJson(const SegmentArguments& o, const SegmentSummary& summary);
/// What says how pieces were merged: the options that the merge mode looks at.
void addMerging(Json& json, const MergeOptions& options);
void print(const SegmentArguments& o, const Common& common, const SegmentSummary& summary);

}  // namespace vdb_madf::tools
