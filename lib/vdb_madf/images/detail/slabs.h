// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <algorithm>
#include <cstdint>

#include "vdb_madf/base/errors.h"
#include "vdb_madf/base/interrupter.h"

namespace vdb_madf::detail {

/// Slices of a slab, at most.
constexpr int kSlab = 8;

/// Calls body(z, count) for the slices from `begin` to `end` (exclusive), eight at a time, in
/// ascending order: from one multiple of eight to the next, so that each slab is one layer of
/// leaves. The interrupter is asked before each. @throw Interrupted; what body throws.
template <typename Body>
void forEachSlab(int begin, int end, Interrupter* interrupter, const Body& body) {
  for (int z = begin, next; z < end; z = next) {
    if (interrupter &&
        interrupter->wasInterrupted(int((int64_t(z) - begin) * 100 / (int64_t(end) - begin))))
      throw Interrupted();
    next = std::min((z & ~(kSlab - 1)) + kSlab, end);
    body(z, next - z);
  }
}

}  // namespace vdb_madf::detail
