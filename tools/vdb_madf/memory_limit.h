// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstdint>
#include <string>

namespace vdb_madf::tools {

/// "500M", "12GiB", "16e9": bytes; K, M, G, T with or without iB are powers of 1024, with B of
/// 1000.
/// @throw WrongUsage
int64_t parseMemory(const std::string& text);

/// "3.2 GiB"
std::string readableBytes(int64_t bytes);

}  // namespace vdb_madf::tools
