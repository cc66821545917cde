// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/base/detail/pages.h"

#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <new>

namespace vdb_madf::detail {

namespace {

constexpr size_t kHugePage = size_t(1) << 21;

}  // namespace

void* allocatePages(size_t bytes) {
  const bool large = bytes >= 4 * kHugePage;
  const size_t alignment = large ? kHugePage : 64;
  void* block = std::aligned_alloc(alignment, (bytes + alignment) & ~(alignment - 1));
  if (!block) throw std::bad_alloc();
#ifdef MADV_HUGEPAGE
  if (large) madvise(block, bytes & ~(kHugePage - 1), MADV_HUGEPAGE);
#endif
  return block;
}

void freePages(void* block) noexcept {
  std::free(block);
}

PageReturn::PageReturn(void* block, size_t bytes)
    : begin_(uintptr_t(block)),
      end_(begin_ + bytes),
      left_((end_ + kHugePage - 1) / kHugePage - begin_ / kHugePage) {
  for (size_t i = 0; i < left_.size(); ++i) left_[i] = bytesIn(i, begin_, end_);
}

size_t PageReturn::bytesIn(size_t page, uintptr_t from, uintptr_t to) const {
  const uintptr_t first = (begin_ / kHugePage + page) * kHugePage;
  return std::min(to, first + kHugePage) - std::max(from, first);
}

void PageReturn::giveBack(size_t begin, size_t end) noexcept {
#ifdef MADV_DONTNEED
  static const uintptr_t small = uintptr_t(sysconf(_SC_PAGESIZE));
  const uintptr_t from = begin_ + begin, to = begin_ + end;
  for (size_t i = from / kHugePage - begin_ / kHugePage; from < to && i < left_.size(); ++i) {
    const uintptr_t first = (begin_ / kHugePage + i) * kHugePage;
    if (first >= to) return;
    const size_t given = bytesIn(i, from, to);
    if (left_[i].fetch_sub(given) != given) continue;
    // Other blocks may lie beside this one.
    const uintptr_t whole = (std::max(begin_, first) + small - 1) & ~(small - 1);
    const uintptr_t stop = std::min(end_, first + kHugePage) & ~(small - 1);
    if (whole < stop)
      madvise(reinterpret_cast<void*>(whole), stop - whole, MADV_DONTNEED);  // NOLINT
  }
#endif
}

}  // namespace vdb_madf::detail
