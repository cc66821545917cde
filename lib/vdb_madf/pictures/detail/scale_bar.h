// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <optional>
#include <string>

#include "vdb_madf/pictures/picture.h"

namespace vdb_madf::detail {

struct ScaleBar {
  double metres = 0;
  int pixels = 0;
  std::string text;  ///< "200 um"
};

/// The longest bar of 1, 2 or 5 times a power of ten (metres) that is not longer than `widest`
/// pixels; none if even a nanometre is.
std::optional<ScaleBar> fitScaleBar(double metresPerPixel, int widest);

/// The bar with its text above it; (left, bottom): the first pixel column of
/// both, the last row.
void draw(const ScaleBar& bar, int left, int bottom, const Rgb& color, Picture& picture);
int height(const ScaleBar& bar);
/// Of the bar or its text, whichever is wider.
int width(const ScaleBar& bar);

}  // namespace vdb_madf::detail
