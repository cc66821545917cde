// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstddef>

namespace vdb_madf::detail {

/// Uninitialised memory; large blocks come in huge pages where the system has them.
/// @throw std::bad_alloc
void* allocatePages(size_t bytes);
void freePages(void* block) noexcept;
/// Gives the whole pages within bytes [begin, end) of a block back to the system; their values are
/// lost. A hint: does nothing where the system cannot.
void discardPages(void* block, size_t begin, size_t end) noexcept;

}  // namespace vdb_madf::detail
