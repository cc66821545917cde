// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <tbb/enumerable_thread_specific.h>

#include <cstddef>
#include <functional>

#include "vdb_madf/grid_types.h"

namespace vdb_madf::detail {

/// Scratch space of one thread: local() is made on first use.
template <typename T>
using PerThread = tbb::enumerable_thread_specific<T>;

/// Runs body(begin, end) over [0, count) in chunks of at least `grain` items, in parallel. The
/// interrupter is asked between chunks, with the percentage done.
/// The one place that knows the threading library. @throw Interrupted; what body throws.
void parallelFor(size_t count, size_t grain, Interrupter* interrupter,
                 const std::function<void(size_t begin, size_t end)>& body);

}  // namespace vdb_madf::detail
