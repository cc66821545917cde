// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <functional>
#include <memory>
#include <string>

#include "vdb_madf/images/image.h"

namespace vdb_madf::detail {

/// The reader that `open` makes, in a process of its own: for libraries that crash on damaged
/// files. The process is a fork of this one; it opens the file, sends slices through a socket,
/// and ends with the reader. If it crashes, that is an IoError like any other.
/// @param open runs in that process, which has no other thread: it must not start any
/// @throw IoError, InvalidInput: what `open` throws; IoError if it crashed
std::unique_ptr<ImageReader> openIsolated(
    const std::string& path, const std::function<std::unique_ptr<ImageReader>()>& open);

}  // namespace vdb_madf::detail
