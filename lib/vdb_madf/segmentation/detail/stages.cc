// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/segmentation/detail/stages.h"

#include <algorithm>
#include <string>

#include "vdb_madf/base/errors.h"
#include "vdb_madf/base/memory.h"

namespace vdb_madf::detail {

namespace {

/// How long the stages take, roughly, for the percentage of the whole: nanoseconds per object
/// voxel, 2 threads.
struct StageWeight {
  const char* stage;
  int weight;
};
constexpr StageWeight kStageWeights[] = {
    {"leaf_index", 1}, {"cavities", 1},       {"squared_distance", 9},
    {"power_map", 25}, {"medial_balls", 2},   {"gamma_filter", 25},
    {"flow", 2},       {"manifold_graph", 4}, {"merge", 1},
    {"tidy", 4},       {"labels", 4}};

int weight(const StageWeight& s, const std::vector<std::string>& omitted) {
  return std::find(omitted.begin(), omitted.end(), s.stage) == omitted.end() ? s.weight : 0;
}

}  // namespace

Stages::Stages(Interrupter* interrupter, const std::vector<std::string>& omitted,
               std::vector<StageTime>& times)
    : interrupter_(interrupter), omitted_(omitted), times_(times) {
  for (const StageWeight& s : kStageWeights) total_ += weight(s, omitted_);
}

Interrupter* Stages::begin(const char* stage) {
  finish();
  times_.push_back({stage});
  faultsBefore_ = pageFaults();
  start_ = Clock::now();
  running_ = true;
  before_ = largest_ = 0;
  for (const StageWeight& s : kStageWeights) {
    weight_ = weight(s, omitted_);
    if (std::string(stage) == s.stage) break;
    before_ += weight_;
  }
  if (interrupter_) interrupter_->start(stage);
  if (wasInterrupted(0)) throw Interrupted();
  return this;
}

void Stages::finish() {
  if (!running_) return;
  times_.back().seconds = std::chrono::duration<double>(Clock::now() - start_).count();
  times_.back().peakBytes = peakMemory();
  times_.back().pageFaults = pageFaults() - faultsBefore_;
  if (interrupter_) interrupter_->end();
  running_ = false;
}

bool Stages::wasInterrupted(int percent) {
  if (!interrupter_) return false;
  if (percent < 0) return interrupter_->wasInterrupted(percent);
  int largest = largest_;
  while (percent > largest && !largest_.compare_exchange_weak(largest, percent)) continue;
  return interrupter_->wasInterrupted((100 * before_ + std::max(percent, largest) * weight_) /
                                      total_);
}

}  // namespace vdb_madf::detail
