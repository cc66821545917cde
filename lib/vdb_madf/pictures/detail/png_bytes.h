// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <string>

#include "vdb_madf/pictures/picture.h"

namespace vdb_madf::detail {

/// An RGB PNG of 8 bits a channel that says 300 dpi. The picture has at least one pixel.
/// @throw std::runtime_error with libpng's words
std::string pngBytes(const Picture& picture);

}  // namespace vdb_madf::detail
