// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "progress.h"

#include <tbb/global_control.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <utility>

#include "message.h"

namespace vdb_madf::tools {

namespace {

std::atomic<bool> interruptRequested{false};
static_assert(std::atomic<bool>::is_always_lock_free, "set from a signal handler");

/// The first signal asks; should the program be where it cannot hear, a second one ends it.
void onSignal(int signal) {
  interruptRequested = true;
  std::signal(signal, SIG_DFL);
}

constexpr auto kShowEvery = std::chrono::milliseconds(100);

/// A terminal on which a line can be written anew.
bool isTerminal() {
  const char* kind = std::getenv("TERM");
  return isatty(STDERR_FILENO) && kind && std::strcmp(kind, "dumb") != 0;
}

}  // namespace

void catchInterrupts() {
  std::signal(SIGINT, onSignal);
  std::signal(SIGTERM, onSignal);
  std::signal(SIGQUIT, onSignal);
  if (std::signal(SIGHUP, onSignal) == SIG_IGN) std::signal(SIGHUP, SIG_IGN);  // nohup
  std::signal(SIGXFSZ, SIG_IGN);
}

Progress::Progress(bool quiet, std::string work)
    : quiet_(quiet), show_(!quiet && isTerminal()), work_(std::move(work)) {}

Progress::~Progress() {
  clearLine();
}

void Progress::start(const char* name) {
  const std::lock_guard<std::mutex> lock(mutex_);
  stage_ = name ? name : "";
}

void Progress::end() {
  const std::lock_guard<std::mutex> lock(mutex_);
  stage_.clear();
  clearLine();
}

void Progress::note(const std::string& text) {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (std::find(notes_.begin(), notes_.end(), text) != notes_.end()) return;
  notes_.push_back(text);
  clearLine();
  if (!quiet_) printMessage("note", text);
}

bool Progress::wasInterrupted(int percent) {
  if (show_ && percent >= 0) {
    const std::unique_lock<std::mutex> lock(mutex_, std::try_to_lock);
    const auto now = std::chrono::steady_clock::now();
    if (lock.owns_lock() && now - lastShown_ > kShowEvery) {
      std::fprintf(stderr, "\r\033[K%s %d %%%s", (stage_.empty() ? work_ : stage_).c_str(), percent,
                   remainingTime(percent, now).c_str());
      lineShown_ = true;
      lastShown_ = now;
    }
  }
  return interruptRequested;
}

/// From the pace since the percentage began to grow; nothing while that tells little.
std::string Progress::remainingTime(int percent, std::chrono::steady_clock::time_point now) {
  constexpr int kFallback = 20;  // less: threads that report out of order
  if (percent < lastPercent_ - kFallback) {
    firstPercent_ = percent;
    firstTime_ = now;
  }
  lastPercent_ = percent;
  const double elapsed = std::chrono::duration<double>(now - firstTime_).count();
  if (elapsed < 1 || percent - firstPercent_ < 3) return {};
  const double seconds = elapsed * (100 - percent) / (percent - firstPercent_);
  char text[64];
  if (seconds < 90)
    std::snprintf(text, sizeof text, ", %.0f s left", seconds);
  else
    std::snprintf(text, sizeof text, ", %.0f min left", seconds / 60);
  return text;
}

void Progress::clearLine() {
  if (lineShown_) std::fprintf(stderr, "\r\033[K");
  lineShown_ = false;
}

int usedThreads(int option) {
  if (option > 0) return option;
  return int(tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism));
}

}  // namespace vdb_madf::tools
