// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <string>

#include "vdb_madf/pictures/picture.h"

namespace vdb_madf::detail {

constexpr int kGlyphHeight = 7;  ///< pixels at scale 1

/// Width of a text in pixels: five a letter and one between letters, times the scale.
int textWidth(const std::string& text, int scale);

/// Draws digits, ".", "-" and the letters m n u x y z; other characters are left blank. What lies
/// outside of the picture is cut off. (left, top): the text's corner.
void drawText(Picture& picture, int left, int top, const std::string& text, const Rgb& color,
              int scale);

}  // namespace vdb_madf::detail
