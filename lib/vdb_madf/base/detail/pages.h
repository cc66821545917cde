// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <new>
#include <utility>
#include <vector>

namespace vdb_madf::detail {

/// Uninitialized memory; large blocks come in huge pages where the system has them.
/// @throw std::bad_alloc
void* allocatePages(size_t bytes);
void freePages(void* block) noexcept;

/// Memory that was freed, and that the allocator (mimalloc's, or that of glibc) keeps for its next
/// blocks, goes back to the system as far as it can. For steps of a long work that is held to a
/// limit: what one step leaves so is counted beside what the next one takes.
void returnFreedMemory() noexcept;

/// Lets a vector take its numbers from allocatePages(), and not clear them when it grows.
template <typename T>
struct PageAllocator {
  using value_type = T;
  PageAllocator() = default;
  template <typename U>
  PageAllocator(const PageAllocator<U>&) {}
  T* allocate(size_t count) { return static_cast<T*>(allocatePages(count * sizeof(T))); }
  void deallocate(T* values, size_t) noexcept { freePages(values); }
  template <typename U>
  void construct(U*) noexcept {}
  template <typename U, typename... Arguments>
  void construct(U* value, Arguments&&... arguments) {
    new (value) U(std::forward<Arguments>(arguments)...);
  }
  template <typename U>
  bool operator==(const PageAllocator<U>&) const {
    return true;
  }
  template <typename U>
  bool operator!=(const PageAllocator<U>&) const {
    return false;
  }
};

/// Gives a block back to the system while parts of it are still in use: a huge page at a time, as
/// soon as nothing in it is, so that who asks for huge pages next gets these. (A first touch of
/// memory that was not in use before costs up to twenty times as much in virtual machines that are
/// given it on demand.) Where the system cannot, nothing happens.
class PageReturn {
 public:
  PageReturn(void* block, size_t bytes);
  /// The values of bytes [begin, end) are lost. For each byte once, from any thread.
  void giveBack(size_t begin, size_t end) noexcept;

 private:
  /// The number of bytes [from, to) in the huge page of that number, which they meet.
  static size_t bytesIn(uintptr_t page, uintptr_t from, uintptr_t to);

  uintptr_t begin_, end_;
  std::vector<std::atomic<size_t>> left_;  // of each huge page, the bytes that are in use
};

}  // namespace vdb_madf::detail
