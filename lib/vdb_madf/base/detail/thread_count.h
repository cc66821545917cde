// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstddef>

namespace vdb_madf::detail {

/// How many threads a loop has at most.
size_t threadCount();

}  // namespace vdb_madf::detail
