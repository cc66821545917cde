// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

namespace vdb_madf::detail {

/// JSON that is nested more deeply is refused while it is parsed: copies of it, and its text, are
/// made by recursion, which would overrun the stack.
constexpr int kMaxJsonDepth = 64;

}  // namespace vdb_madf::detail
