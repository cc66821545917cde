// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/base/detail/parallel.h"

#include <tbb/blocked_range.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>

#include <atomic>
#include <exception>
#include <mutex>

#include "vdb_madf/base/detail/thread_count.h"
#include "vdb_madf/base/errors.h"

namespace vdb_madf::detail {

size_t threadCount() {
  return tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism);
}

void parallelFor(size_t count, size_t grain, Interrupter* interrupter,
                 const std::function<void(size_t, size_t)>& body) {
  if (count == 0) return;
  std::atomic<size_t> done{0};
  std::atomic<bool> stop{false};
  std::mutex mutex;
  std::exception_ptr failure;
  tbb::parallel_for(
      tbb::blocked_range<size_t>(0, count, grain),
      [&](const tbb::blocked_range<size_t>& range) {
        if (stop.load(std::memory_order_relaxed)) return;
        try {
          if (interrupter && interrupter->wasInterrupted(int(done.load() * 100 / count)))
            throw Interrupted();
          body(range.begin(), range.end());
          done += range.size();
        } catch (...) {
          // Not left to TBB, which would end OpenVDB's loops in other chunks halfway, whose callers
          // take no half results.
          const std::lock_guard<std::mutex> lock(mutex);
          if (!failure) failure = std::current_exception();
          stop = true;
        }
      },
      tbb::simple_partitioner());
  if (failure) std::rethrow_exception(failure);
}

}  // namespace vdb_madf::detail
