// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <string>

#include "vdb_madf/pictures/picture.h"

namespace vdb_madf {

/// The bytes of an RGB PNG of 8 bits a channel at 300 dpi. The picture has at least one pixel.
/// @throw IoError with libpng's words
std::string pngBytes(const Picture& picture);

/// The bytes of an RGBA PNG of a picture that was drawn twice, on white and on black: it is covered
/// where both are alike.
std::string pngBytes(const Picture& onWhite, const Picture& onBlack);

/// Writes an RGB PNG of 8 bits a channel at 300 dpi, whole or not at all. It is made in memory
/// first: about three bytes a pixel. The picture has at least one pixel.
/// @throw IoError, one line that names the file.
void writePng(const std::string& path, const Picture& picture);
void writePng(const std::string& path, const Picture& onWhite, const Picture& onBlack);

}  // namespace vdb_madf
