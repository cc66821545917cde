// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstddef>
#include <cstdint>

namespace vdb_madf::detail {

/// Bit i, i < count <= 64: does values[i] differ from the value before it? `before`: before the
/// first.
uint64_t runStarts(const uint32_t* values, size_t count, uint32_t before);

}  // namespace vdb_madf::detail
