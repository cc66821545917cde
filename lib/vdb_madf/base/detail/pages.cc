// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/base/detail/pages.h"

#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <new>

#ifdef __GLIBC__
#include <malloc.h>
#endif

#if defined(__GNUC__) && defined(__ELF__)
// Of programs that are linked to mimalloc. (The library does not know which allocator it gets.)
extern "C" void mi_collect(bool force) noexcept __attribute__((weak));
#define VDB_MADF_MAY_HAVE_MIMALLOC
#endif

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

void returnFreedMemory() noexcept {
#ifdef VDB_MADF_MAY_HAVE_MIMALLOC
  if (mi_collect) mi_collect(true);
#endif
#ifdef __GLIBC__
  malloc_trim(0);
#endif
}

PageReturn::PageReturn(void* block, size_t bytes)
    : begin_(uintptr_t(block)),
      end_(begin_ + bytes),
      left_((end_ + kHugePage - 1) / kHugePage - begin_ / kHugePage) {
  for (size_t i = 0; i < left_.size(); ++i)
    left_[i] = bytesIn(begin_ / kHugePage + i, begin_, end_);
}

size_t PageReturn::bytesIn(uintptr_t page, uintptr_t from, uintptr_t to) {
  return std::min(to, (page + 1) * kHugePage) - std::max(from, page * kHugePage);
}

void PageReturn::giveBack(size_t begin, size_t end) noexcept {
#ifdef MADV_DONTNEED
  static const uintptr_t small = uintptr_t(sysconf(_SC_PAGESIZE));
  const uintptr_t from = begin_ + begin, to = begin_ + end;
  for (uintptr_t page = from / kHugePage; page * kHugePage < to; ++page) {
    const size_t given = bytesIn(page, from, to);
    if (left_[page - begin_ / kHugePage].fetch_sub(given) != given) continue;
    // Other blocks may lie beside this one.
    const uintptr_t first = (std::max(begin_, page * kHugePage) + small - 1) & ~(small - 1);
    const uintptr_t stop = std::min(end_, (page + 1) * kHugePage) & ~(small - 1);
    if (first < stop)
      madvise(reinterpret_cast<void*>(first), stop - first, MADV_DONTNEED);  // NOLINT
  }
#endif
}

}  // namespace vdb_madf::detail
