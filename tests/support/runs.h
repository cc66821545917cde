// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include <atomic>
#include <cstdint>
#include <cstdlib>

#include "vdb_madf/grids/grid_types.h"

/// Ways to run a stage: with a number of threads, and stopped at once; how often.
namespace vdb_madf::test {

inline uint64_t fromEnvironment(const char* variable, uint64_t otherwise) {
  const char* value = std::getenv(variable);
  return value ? std::strtoull(value, nullptr, 10) : otherwise;
}

/// What f() returns with that many threads, whatever the machine has.
template <typename F>
auto withThreads(int threads, const F& f) {
  // The arena allows more threads than the machine has cores, the control fewer.
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, size_t(threads));
  return tbb::task_arena(threads).execute(f);
}

class StopAtOnce : public Interrupter {
 public:
  bool wasInterrupted(int /*percent*/) override { return true; }
};

/// Stops what has asked that many times.
class StopAfter : public Interrupter {
 public:
  explicit StopAfter(int polls) : polls_(polls) {}
  bool wasInterrupted(int /*percent*/) override {
    ++asked;
    return --polls_ < 0;
  }
  std::atomic<int> asked{0};

 private:
  std::atomic<int> polls_;
};

}  // namespace vdb_madf::test
