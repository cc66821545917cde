// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_sort.h>

#include <algorithm>
#include <cstddef>
#include <functional>
#include <vector>

#include "vdb_madf/base/interrupter.h"

namespace vdb_madf::detail {

/// Scratch space of one thread: local() is made on first use.
template <typename T>
using PerThread = tbb::enumerable_thread_specific<T>;

/// Sorts in parallel. Equal items come in any order: give a total order.
template <typename Iterator, typename Less>
void parallelSort(Iterator begin, Iterator end, const Less& less) {
  tbb::parallel_sort(begin, end, less);
}
template <typename Iterator>
void parallelSort(Iterator begin, Iterator end) {
  tbb::parallel_sort(begin, end);
}

/// Part of a longer work, from `begin` to `end` per cent of it: what is done in several loops tells
/// its progress as one.
class WorkPart : public Interrupter {
 public:
  WorkPart(Interrupter* whole, int begin, int end) : whole_(whole), begin_(begin), end_(end) {}
  bool wasInterrupted(int percent) override {
    if (!whole_) return false;
    return whole_->wasInterrupted(percent < 0 ? percent : begin_ + percent * (end_ - begin_) / 100);
  }

 private:
  Interrupter* whole_;
  int begin_, end_;
};

/// Runs body(begin, end) over [0, count) in chunks of at most `grain` items, in parallel. The
/// interrupter is asked between chunks, with the percentage done. Where one fails, or the
/// interrupter stops them, chunks that run go on to their ends.
/// The one place that knows the threading library. @throw Interrupted; what body throws.
void parallelFor(size_t count, size_t grain, Interrupter* interrupter,
                 const std::function<void(size_t begin, size_t end)>& body);

/// Runs f(i) for all i of [0, count), as parallelFor() does.
template <typename F>
void parallelForEach(size_t count, size_t grain, Interrupter* interrupter, const F& f) {
  parallelFor(count, grain, interrupter, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) f(i);
  });
}

/// All items, in their order. Each chunk is given back once it was copied.
template <typename Item>
std::vector<Item> concatenated(std::vector<std::vector<Item>> chunks) {
  size_t count = 0;
  for (const std::vector<Item>& chunk : chunks) count += chunk.size();
  std::vector<Item> all;
  all.reserve(count);
  for (std::vector<Item>& chunk : chunks) {
    all.insert(all.end(), chunk.begin(), chunk.end());
    chunk = {};
  }
  return all;
}

/// What f(i, some) adds to `some` for each i of [0, count), in the order of i; items are found in
/// parallel. For the interrupter see parallelFor().
template <typename Item, typename F>
std::vector<Item> parallelCollect(size_t count, size_t grain, Interrupter* interrupter,
                                  const F& f) {
  std::vector<std::vector<Item>> chunks((count + grain - 1) / grain);
  parallelForEach(chunks.size(), 1, interrupter, [&](size_t chunk) {
    const size_t end = std::min(count, (chunk + 1) * grain);
    for (size_t i = chunk * grain; i < end; ++i) f(i, chunks[chunk]);
  });
  return concatenated(std::move(chunks));
}

}  // namespace vdb_madf::detail
