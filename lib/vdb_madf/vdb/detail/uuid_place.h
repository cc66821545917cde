// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstddef>

namespace vdb_madf::detail {

/// Where the UUID stands in a VDB file, as text.
constexpr size_t kUuidStart = 21, kUuidLength = 36;

}  // namespace vdb_madf::detail
