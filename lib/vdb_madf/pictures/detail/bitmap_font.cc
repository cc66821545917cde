// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/pictures/detail/bitmap_font.h"

#include <array>
#include <string_view>

namespace vdb_madf::detail {

namespace {

constexpr int kGlyphWidth = 5;

struct Glyph {
  char character;
  std::array<std::string_view, kGlyphHeight> rows;
};

constexpr Glyph kGlyphs[] = {
    {'0', {".###.", "#...#", "#..##", "#.#.#", "##..#", "#...#", ".###."}},
    {'1', {"..#..", ".##..", "..#..", "..#..", "..#..", "..#..", ".###."}},
    {'2', {".###.", "#...#", "....#", "..##.", ".#...", "#....", "#####"}},
    {'3', {".###.", "#...#", "....#", "..##.", "....#", "#...#", ".###."}},
    {'4', {"...#.", "..##.", ".#.#.", "#..#.", "#####", "...#.", "...#."}},
    {'5', {"#####", "#....", "####.", "....#", "....#", "#...#", ".###."}},
    {'6', {"..##.", ".#...", "#....", "####.", "#...#", "#...#", ".###."}},
    {'7', {"#####", "....#", "...#.", "..#..", "..#..", ".#...", ".#..."}},
    {'8', {".###.", "#...#", "#...#", ".###.", "#...#", "#...#", ".###."}},
    {'9', {".###.", "#...#", "#...#", ".####", "....#", "...#.", ".##.."}},
    {'.', {".....", ".....", ".....", ".....", ".....", ".##..", ".##.."}},
    {'-', {".....", ".....", ".....", ".###.", ".....", ".....", "....."}},
    {'m', {".....", ".....", "##.#.", "#.#.#", "#.#.#", "#.#.#", "#.#.#"}},
    {'n', {".....", ".....", "#.##.", "##..#", "#...#", "#...#", "#...#"}},
    {'u', {".....", ".....", "#...#", "#...#", "#...#", "#..##", ".##.#"}},
    {'x', {".....", ".....", "#...#", ".#.#.", "..#..", ".#.#.", "#...#"}},
    {'y', {".....", ".....", "#...#", "#...#", ".####", "....#", ".###."}},
    {'z', {".....", ".....", "#####", "...#.", "..#..", ".#...", "#####"}},
};

const Glyph* find(char character) {
  for (const Glyph& glyph : kGlyphs)
    if (glyph.character == character) return &glyph;
  return nullptr;
}

}  // namespace

int textWidth(const std::string& text, int scale) {
  return text.empty() ? 0 : (int(text.size()) * (kGlyphWidth + 1) - 1) * scale;
}

void drawText(Picture& picture, int left, int top, const std::string& text, const Rgb& color,
              int scale) {
  for (size_t i = 0; i < text.size(); ++i) {
    const Glyph* glyph = find(text[i]);
    if (!glyph) continue;
    for (int y = 0; y < kGlyphHeight * scale; ++y)
      for (int x = 0; x < kGlyphWidth * scale; ++x) {
        const int px = left + int(i) * (kGlyphWidth + 1) * scale + x, py = top + y;
        const bool inside = px >= 0 && py >= 0 && px < picture.width && py < picture.height;
        if (inside && glyph->rows[size_t(y / scale)][size_t(x / scale)] == '#')
          picture.at(px, py) = color;
      }
  }
}

}  // namespace vdb_madf::detail
