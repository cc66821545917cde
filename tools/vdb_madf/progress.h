// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <chrono>
#include <mutex>
#include <string>
#include <vector>

#include "vdb_madf/grids/grid_types.h"

namespace vdb_madf::tools {

/// What is said while the work is under way: one progress line (stage, percentage, remaining time)
/// on stderr when that is a terminal (TERM not dumb), and notes. Also turns Ctrl-C into a cancel.
class Progress : public Interrupter {
 public:
  /// @param work is shown outside of named stages
  Progress(bool quiet, std::string work);
  ~Progress() override;
  void start(const char* name) override;
  void end() override;  ///< also takes the line away: results may follow on the same terminal
  bool wasInterrupted(int percent) override;
  /// Prints what the user should know though it is no error, once, unless quiet.
  void note(const std::string& text);
  const std::vector<std::string>& notes() const { return notes_; }

 private:
  void clearLine();
  std::string remainingTime(int percent, std::chrono::steady_clock::time_point now);

  const bool quiet_, show_;
  const std::string work_;
  std::mutex mutex_;
  std::string stage_;
  std::vector<std::string> notes_;
  bool lineShown_ = false;
  std::chrono::steady_clock::time_point lastShown_;
  // The time and place at which the percentage began to grow: it falls back when a new work begins.
  int firstPercent_ = 0, lastPercent_ = 101;
  std::chrono::steady_clock::time_point firstTime_;
};

/// From now on Ctrl-C, SIGQUIT, termination requests and a closed terminal are taken by Progress,
/// and a write beyond the limit of file sizes fails like any other: no signal may end the program
/// before it has removed its temporary files.
void catchInterrupts();

/// The number of threads that work: what the option says, or all (0).
int usedThreads(int option);

}  // namespace vdb_madf::tools
