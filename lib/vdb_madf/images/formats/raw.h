// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <memory>
#include <string>

#include "vdb_madf/files/detail/input_file.h"
#include "vdb_madf/images/image.h"
#include "vdb_madf/images/open_image.h"

namespace vdb_madf::detail {

/// Samples without a header, or after one of a known length; nothing follows them.
std::unique_ptr<ImageReader> openRaw(std::unique_ptr<InputFile> file, const RawLayout& layout);
std::unique_ptr<ImageWriter> createRaw(const std::string& path, const ImageInfo& info);

}  // namespace vdb_madf::detail
