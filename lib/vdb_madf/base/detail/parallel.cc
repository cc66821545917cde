// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/base/detail/parallel.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <atomic>

#include "vdb_madf/base/errors.h"

namespace vdb_madf::detail {

void parallelFor(size_t count, size_t grain, Interrupter* interrupter,
                 const std::function<void(size_t, size_t)>& body) {
  if (count == 0) return;
  std::atomic<size_t> done{0};
  std::atomic<bool> stop{false};
  tbb::task_group_context context;
  tbb::parallel_for(
      tbb::blocked_range<size_t>(0, count, grain),
      [&](const tbb::blocked_range<size_t>& range) {
        if (stop.load(std::memory_order_relaxed)) return;
        if (interrupter && interrupter->wasInterrupted(int(done.load() * 100 / count))) {
          stop = true;
          context.cancel_group_execution();
          return;
        }
        body(range.begin(), range.end());
        done += range.size();
      },
      tbb::simple_partitioner(), context);
  if (stop) throw Interrupted();
}

}  // namespace vdb_madf::detail
