// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/pictures/detail/scale_bar.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "vdb_madf/pictures/detail/bitmap_font.h"

namespace vdb_madf::detail {

namespace {

constexpr int kTextScale = 2, kThickness = 4, kTextGap = 4;  // pixels

struct Unit {
  const char* name;
  double metres;
};
constexpr std::array<Unit, 4> kUnits{{{"nm", 1e-9}, {"um", 1e-6}, {"mm", 1e-3}, {"m", 1}}};

}  // namespace

std::optional<ScaleBar> fitScaleBar(double metresPerPixel, int widest) {
  std::optional<ScaleBar> best;
  for (const Unit& unit : kUnits)
    for (const int number : {1, 2, 5, 10, 20, 50, 100, 200, 500}) {
      const double pixels = number * unit.metres / metresPerPixel;
      if (pixels > widest) return best;
      best = ScaleBar{number * unit.metres, int(std::lround(pixels)),
                      std::to_string(number) + " " + unit.name};
    }
  return best;
}

int height(const ScaleBar&) {
  return kThickness + kTextGap + kGlyphHeight * kTextScale;
}

int width(const ScaleBar& bar) {
  return std::max(bar.pixels, textWidth(bar.text, kTextScale));
}

void draw(const ScaleBar& bar, int left, int bottom, const Rgb& color, Picture& picture) {
  for (int y = bottom - kThickness + 1; y <= bottom; ++y)
    for (int x = left; x < left + bar.pixels; ++x)
      if (x >= 0 && y >= 0 && x < picture.width && y < picture.height) picture.at(x, y) = color;
  const int textLeft = left + (bar.pixels - textWidth(bar.text, kTextScale)) / 2;
  drawText(picture, std::max(left, textLeft), bottom - height(bar) + 1, bar.text, color,
           kTextScale);
}

}  // namespace vdb_madf::detail
