// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/base/detail/pages.h"

#include <sys/mman.h>
#include <unistd.h>

#include <cstdint>
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

void discardPages(void* block, size_t begin, size_t end) noexcept {
#ifdef MADV_DONTNEED
  static const uintptr_t page = uintptr_t(sysconf(_SC_PAGESIZE));
  const uintptr_t from = (uintptr_t(block) + begin + page - 1) & ~(page - 1);
  const uintptr_t to = (uintptr_t(block) + end) & ~(page - 1);
  if (from < to)
    madvise(static_cast<char*>(block) + (from - uintptr_t(block)), to - from, MADV_DONTNEED);
#endif
}

}  // namespace vdb_madf::detail
