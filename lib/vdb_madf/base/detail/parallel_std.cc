// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

// The loops by plain threads, in the place of parallel.cc (CMake's VDB_MADF_THREADS=std):
// ThreadSanitizer knows what these wait for, but not what TBB's library does. Each loop has new
// threads, and more chunks than it asks for, so that small samples have some for each.

#include <tbb/global_control.h>

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <thread>
#include <utility>
#include <vector>

#include "vdb_madf/base/detail/parallel.h"
#include "vdb_madf/base/detail/thread_count.h"
#include "vdb_madf/base/errors.h"

namespace vdb_madf::detail {

namespace {

constexpr size_t kThreads = 8;
constexpr size_t kChunksPerThread = 4;

/// TBB's own loops, in OpenVDB and to sort, stay in the thread that calls them.
const tbb::global_control kOneThreadOfTbb(tbb::global_control::max_allowed_parallelism, 1);

thread_local bool isInLoop = false;

class PlainLoop {
 public:
  PlainLoop(size_t count, size_t grain, Interrupter* interrupter,
            const std::function<void(size_t, size_t)>& body)
      : count_(count),
        chunk_(std::clamp<size_t>(count / (kThreads * kChunksPerThread), 1, grain)),
        interrupter_(interrupter),
        body_(body) {}

  void run() {
    std::vector<std::thread> others;
    if (!isInLoop && chunk_ < count_)
      for (size_t i = 1; i < kThreads; ++i) others.emplace_back([this] { work(); });
    work();
    for (std::thread& thread : others) thread.join();
    if (error_) std::rethrow_exception(error_);
    if (interrupted_) throw Interrupted();
  }

 private:
  void work() {
    const bool outer = std::exchange(isInLoop, true);
    try {
      while (!stop_.load(std::memory_order_relaxed) && takeChunk()) {
      }
    } catch (...) {
      const std::lock_guard<std::mutex> lock(mutex_);
      if (!error_) error_ = std::current_exception();
      stop_ = true;
    }
    isInLoop = outer;
  }

  /// False if there is none left. (Relaxed: the counters must not put the chunks into an order, or
  /// races between them would go unseen.)
  bool takeChunk() {
    const size_t begin = next_.fetch_add(chunk_, std::memory_order_relaxed);
    if (begin >= count_) return false;
    const size_t done = done_.load(std::memory_order_relaxed);
    if (interrupter_ && interrupter_->wasInterrupted(int(done * 100 / count_))) {
      interrupted_ = stop_ = true;
      return false;
    }
    const size_t end = std::min(begin + chunk_, count_);
    body_(begin, end);
    done_.fetch_add(end - begin, std::memory_order_relaxed);
    return true;
  }

  const size_t count_, chunk_;
  Interrupter* const interrupter_;
  const std::function<void(size_t, size_t)>& body_;
  std::atomic<size_t> next_{0}, done_{0};
  std::atomic<bool> stop_{false}, interrupted_{false};
  std::mutex mutex_;
  std::exception_ptr error_;
};

}  // namespace

size_t threadCount() {
  return kThreads;
}

void parallelFor(size_t count, size_t grain, Interrupter* interrupter,
                 const std::function<void(size_t, size_t)>& body) {
  if (count > 0) PlainLoop(count, grain, interrupter, body).run();
}

}  // namespace vdb_madf::detail
