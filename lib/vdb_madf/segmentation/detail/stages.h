// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <atomic>
#include <chrono>
#include <string>
#include <vector>

#include "vdb_madf/segmentation/segment.h"

namespace vdb_madf::detail {

/// Keeps the time and memory of each stage, and tells the caller's interrupter what is going on:
/// the stage, and the percentage of all stages.
class Stages : public Interrupter {
 public:
  /// @param omitted stages that are not done
  Stages(Interrupter* interrupter, const std::vector<std::string>& omitted,
         std::vector<StageTime>& times);
  ~Stages() override { finish(); }
  Stages(const Stages&) = delete;
  Stages& operator=(const Stages&) = delete;

  /// Ends the stage before. @return this, for the stage to be told of
  /// @throw Interrupted
  Interrupter* begin(const char* stage);
  void finish();

  /// Work in several loops counts each from 0: within a stage the percentage never falls.
  bool wasInterrupted(int percent) override;

 private:
  using Clock = std::chrono::steady_clock;

  Interrupter* interrupter_;
  std::vector<std::string> omitted_;
  std::vector<StageTime>& times_;
  Clock::time_point start_;
  int64_t faultsBefore_ = 0;
  bool running_ = false;
  int before_ = 0, weight_ = 0, total_ = 0;
  std::atomic<int> largest_{0};  // per cent of the stage
};

}  // namespace vdb_madf::detail
