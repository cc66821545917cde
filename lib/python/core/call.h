// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <pybind11/pybind11.h>
#include <tbb/task_arena.h>

#include <atomic>
#include <chrono>
#include <exception>
#include <string>
#include <thread>

#include "vdb_madf/base/errors.h"
#include "vdb_madf/base/interrupter.h"

namespace vdb_madf::python {

namespace py = pybind11;

/// How the library is called: who hears how far it is, and on how many threads it works.
struct Call {
  py::object progress = py::none();  ///< called with percent (0 to 100) and stage, or None
  int threads = 0;                   ///< 0: all
};

/// Asks Python for signals, and tells it how far the work is: in the thread that made the call, and
/// at most 20 times a second. What that raises stops the work.
class Monitor : public Interrupter {
 public:
  explicit Monitor(const Call& call)
      : progress_(call.progress), caller_(std::this_thread::get_id()) {}

  void start(const char* stage) override;
  bool wasInterrupted(int percent) override;
  /// Throws what was raised, if anything was. The caller holds the lock of the interpreter.
  void rethrow() const {
    if (raised_) std::rethrow_exception(raised_);
  }

 private:
  using Clock = std::chrono::steady_clock;
  void ask(int percent);

  const py::handle progress_;  // of the call, which lives longer
  const std::thread::id caller_;
  std::string stage_;
  Clock::time_point last_ = Clock::now();
  std::exception_ptr raised_;
  std::atomic<bool> stop_{false};
};

/// work(interrupter), without the lock of the interpreter.
template <typename Work>
auto withoutLock(const Call& call, const Work& work) {
  Monitor monitor(call);
  try {
    auto result = [&] {
      const py::gil_scoped_release release;
      if (call.threads <= 0) return work(&monitor);
      return tbb::task_arena(call.threads).execute([&] { return work(&monitor); });
    }();
    monitor.rethrow();
    return result;
  } catch (const Interrupted&) {
    monitor.rethrow();
    throw;
  }
}

}  // namespace vdb_madf::python
