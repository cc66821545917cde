// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <atomic>
#include <chrono>
#include <mutex>
#include <string>

#include "vdb_madf/grid_types.h"

namespace vdb_madf::tools {

/// Shows one progress line on stderr when that is a terminal, and turns Ctrl-C into a cancel.
class Progress : public Interrupter {
 public:
  explicit Progress(bool quiet);
  ~Progress() override;
  void start(const char* name) override;
  void end() override;
  bool wasInterrupted(int percent) override;

 private:
  void clearLine();

  const bool show_;
  std::mutex mutex_;
  std::string stage_;
  bool lineShown_ = false;
  std::chrono::steady_clock::time_point lastShown_;
};

/// From now on Ctrl-C and termination requests are taken by Progress.
void catchInterrupts();

}  // namespace vdb_madf::tools
