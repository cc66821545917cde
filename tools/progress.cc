// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "progress.h"

#include <unistd.h>

#include <csignal>
#include <cstdio>
#include <utility>

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

}  // namespace

void catchInterrupts() {
  std::signal(SIGINT, onSignal);
  std::signal(SIGTERM, onSignal);
  if (std::signal(SIGHUP, onSignal) == SIG_IGN) std::signal(SIGHUP, SIG_IGN);  // nohup
  std::signal(SIGXFSZ, SIG_IGN);
}

Progress::Progress(bool quiet, std::string work)
    : show_(!quiet && isatty(STDERR_FILENO)), work_(std::move(work)) {}

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

bool Progress::wasInterrupted(int percent) {
  if (show_ && percent >= 0) {
    const std::unique_lock<std::mutex> lock(mutex_, std::try_to_lock);
    const auto now = std::chrono::steady_clock::now();
    if (lock.owns_lock() && now - lastShown_ > kShowEvery) {
      std::fprintf(stderr, "\r\033[K%s %d %%", (stage_.empty() ? work_ : stage_).c_str(), percent);
      lineShown_ = true;
      lastShown_ = now;
    }
  }
  return interruptRequested;
}

void Progress::clearLine() {
  if (lineShown_) std::fprintf(stderr, "\r\033[K");
  lineShown_ = false;
}

}  // namespace vdb_madf::tools
