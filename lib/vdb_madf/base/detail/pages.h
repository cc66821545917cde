// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstddef>
#include <new>
#include <utility>

namespace vdb_madf::detail {

/// Uninitialized memory; large blocks come in huge pages where the system has them.
/// @throw std::bad_alloc
void* allocatePages(size_t bytes);
void freePages(void* block) noexcept;

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

/// Gives the whole pages within bytes [begin, end) of a block back to the system; their values are
/// lost. A hint: does nothing where the system cannot.
void discardPages(void* block, size_t begin, size_t end) noexcept;

}  // namespace vdb_madf::detail
