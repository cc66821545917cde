// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

// Where memory ends, the operators new of mimalloc end the program (it is compiled as C, and cannot
// throw). These throw, so that a line can say so. Their memory is mimalloc's, too, whose malloc()
// takes the place of the system's, and goes back by its operators delete.

#ifdef VDB_MADF_MIMALLOC
#include <algorithm>
#include <cstddef>
#include <cstdlib>
#include <new>

namespace {

void* orThrow(void* memory) {
  if (!memory) throw std::bad_alloc();
  return memory;
}
void* aligned(size_t bytes, std::align_val_t to) {
  void* memory = nullptr;
  const size_t least = sizeof(void*);  // that posix_memalign() takes
  return ::posix_memalign(&memory, std::max(size_t(to), least), bytes) == 0 ? memory : nullptr;
}

}  // namespace

void* operator new(size_t bytes) {
  return orThrow(std::malloc(bytes));
}
void* operator new[](size_t bytes) {
  return orThrow(std::malloc(bytes));
}
void* operator new(size_t bytes, std::align_val_t to) {
  return orThrow(aligned(bytes, to));
}
void* operator new[](size_t bytes, std::align_val_t to) {
  return orThrow(aligned(bytes, to));
}
#endif
