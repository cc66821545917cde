// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/pictures/picture_sheet.h"

#include <algorithm>

#include "vdb_madf/pictures/detail/bitmap_font.h"
#include "vdb_madf/pictures/detail/scale_bar.h"

namespace vdb_madf {

namespace {

constexpr Rgb kMargin{255, 255, 255}, kInk{40, 40, 40};
constexpr int kGap = 12;          // pixels between panels, and around them
constexpr int kCaptionScale = 2;  // pixels of the picture per pixel of a letter
constexpr int kCaptionHeight = 32;

void copy(const Picture& from, int left, int top, Picture& to) {
  for (int y = 0; y < from.height; ++y)
    std::copy_n(&from.at(0, y), from.width, &to.at(left, top + y));
}

}  // namespace

Picture coarsened(const Picture& fine, int factor) {
  Picture coarse(std::max(1, fine.width / factor), std::max(1, fine.height / factor), kMargin);
  for (int y = 0; y < coarse.height; ++y)
    for (int x = 0; x < coarse.width; ++x)
      for (size_t channel = 0; channel < 3; ++channel) {
        int sum = 0;
        for (int j = 0; j < factor; ++j)
          for (int i = 0; i < factor; ++i)
            sum += fine.at(std::min(x * factor + i, fine.width - 1),
                           std::min(y * factor + j, fine.height - 1))[channel];
        coarse.at(x, y)[channel] = uint8_t((sum + factor * factor / 2) / (factor * factor));
      }
  return coarse;
}

Picture pictureSheet(const std::vector<PicturePanel>& panels,
                     const std::optional<VoxelSize>& voxelSize) {
  const size_t columns = std::min<size_t>(2, panels.size());
  const size_t rows = (panels.size() + columns - 1) / columns;
  std::vector<int> widths(columns, 0), heights(rows, 0);
  for (size_t i = 0; i < panels.size(); ++i) {
    int& width = widths[i % columns];
    int& height = heights[i / columns];
    width = std::max(width, panels[i].picture.width);
    height = std::max(height, panels[i].picture.height);
  }
  Picture whole(kGap, kGap, kMargin);
  for (const int width : widths) whole.width += width + kGap;
  for (const int height : heights) whole.height += height + kCaptionHeight + kGap;
  whole.pixels.assign(size_t(whole.width) * size_t(whole.height), kMargin);

  int top = kGap;
  for (size_t row = 0; row < rows; ++row) {
    int left = kGap;
    for (size_t i = row * columns; i < std::min(panels.size(), (row + 1) * columns); ++i) {
      const PicturePanel& panel = panels[i];
      const int below = top + heights[row];
      // Slices end above their names; the view stands in the middle.
      const int room = heights[row] - panel.picture.height;
      copy(panel.picture, left, top + (panel.caption.empty() ? room / 2 : room), whole);
      detail::drawText(whole, left, below + kCaptionHeight - detail::kGlyphHeight * kCaptionScale,
                       panel.caption, kInk, kCaptionScale);
      if (voxelSize) {
        const int nameWidth = detail::textWidth(panel.caption, kCaptionScale) + kGap;
        const int right = panel.picture.width;
        const int widest = std::min(right - nameWidth, right / 2);
        // A bar that is narrower than its text ends further left.
        if (const auto bar =
                detail::fitScaleBar(panel.voxelsPerPixel * voxelSize->shortestEdge(), widest);
            bar && detail::width(*bar) <= right - nameWidth)
          detail::draw(*bar, left + right - detail::width(*bar), below + kCaptionHeight - 1, kInk,
                       whole);
      }
      left += widths[i % columns] + kGap;
    }
    top += heights[row] + kCaptionHeight + kGap;
  }
  return whole;
}

}  // namespace vdb_madf
