// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstddef>
#include <string>

namespace vdb_madf::detail {

/// Gray samples of `count` pixels of `channels` samples of `bytes` bytes each, of which the first
/// three (red, green, blue) have to be equal; opacity and what else follows is ignored.
/// @throw IoError that names the file.
void grayOfColors(const std::string& name, const void* pixels, size_t channels, size_t bytes,
                  size_t count, void* samples);

}  // namespace vdb_madf::detail
