// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/pictures/picture_sheet.h"

#include <algorithm>
#include <cmath>

#include "vdb_madf/pictures/detail/canvas.h"
#include "vdb_madf/pictures/detail/scale_bar.h"

namespace vdb_madf {

namespace {

using detail::Canvas;
using detail::ScaleBar;

constexpr Rgb kFrameLine{190, 194, 200};
constexpr double kWideness = 1.5;  ///< width over height of a sheet that is just right

/// A panel with what stands below it: its caption and, beside that or in a second line, its bar.
struct Cell {
  const PicturePanel& panel;
  std::optional<ScaleBar> bar;
  double captionWidth = 0, barWidth = 0;  ///< the bar's with its text
};

/// The sheet, in pixels, but for where its cells stand.
struct Layout {
  double text = 0;  ///< size of the font
  int gap = 0, line = 0;
  int lines = 1;  ///< below a panel
  std::vector<int> widths, heights;

  int width() const {
    int sum = gap;
    for (const int width : widths) sum += width + gap;
    return sum;
  }
  int height() const {
    int sum = gap;
    for (const int height : heights) sum += height + lines * line + gap;
    return sum;
  }
};

std::vector<Cell> cellsOf(const std::vector<PicturePanel>& panels,
                          const std::optional<VoxelSize>& voxelSize, const Layout& layout) {
  std::vector<Cell> cells;
  for (const PicturePanel& panel : panels) {
    Cell cell{panel, std::nullopt, detail::textWidth(panel.caption, layout.text), 0};
    if (voxelSize && panel.voxelsPerPixel > 0) {
      cell.bar = detail::fitScaleBar(panel.voxelsPerPixel * voxelSize->shortestEdge(),
                                     panel.picture.width / 3.0);
      if (cell.bar)
        cell.barWidth =
            cell.bar->pixels + layout.text / 2 + detail::textWidth(cell.bar->text, layout.text);
    }
    cells.push_back(cell);
  }
  return cells;
}

Layout arranged(const std::vector<Cell>& cells, Layout layout, size_t columns) {
  layout.widths.assign(columns, 0);
  layout.heights.assign((cells.size() + columns - 1) / columns, 0);
  for (size_t i = 0; i < cells.size(); ++i) {
    const Cell& cell = cells[i];
    int& width = layout.widths[i % columns];
    int& height = layout.heights[i / columns];
    width = std::max({width, cell.panel.picture.width,
                      int(std::ceil(std::max(cell.captionWidth, cell.barWidth)))});
    height = std::max(height, cell.panel.picture.height);
  }
  return layout;
}

/// The number of columns whose sheet is smallest, if it is wide enough.
Layout bestLayout(const std::vector<Cell>& cells, const Layout& layout) {
  Layout best = layout;
  double least = -1;
  for (size_t columns = 1; columns <= cells.size(); ++columns) {
    const Layout next = arranged(cells, layout, columns);
    const double width = next.width(), height = next.height();
    const double cost =
        std::log(width * height) + 0.4 * std::abs(std::log(width / height / kWideness));
    if (least < 0 || cost < least) {
      least = cost;
      best = next;
    }
  }
  return best;
}

void copy(const Picture& from, int left, int top, Picture& to) {
  for (int y = 0; y < from.height; ++y)
    std::copy_n(&from.at(0, y), from.width, &to.at(left, top + y));
}

void frame(const Picture& around, int left, int top, int thickness, Picture& whole) {
  for (int y = -thickness; y < around.height + thickness; ++y)
    for (int x = -thickness; x < around.width + thickness; ++x)
      if (x < 0 || y < 0 || x >= around.width || y >= around.height)
        whole.at(left + x, top + y) = kFrameLine;
}

/// The caption and the bar; the canvas begins at the panel's lower left corner.
void drawBelow(const Cell& cell, const Layout& layout, const Rgb& ink, Canvas& canvas) {
  const double base = 0.75 * layout.line;
  canvas.text({0, base}, cell.panel.caption, layout.text, ink);
  if (!cell.bar) return;
  const double left = layout.lines > 1 ? 0 : cell.panel.picture.width - cell.barWidth;
  const double bottom = base + (layout.lines - 1) * layout.line;
  const double thickness = std::max(2.0, std::round(layout.text / 5));
  const double middle = std::round(bottom - 0.36 * layout.text);
  canvas.rectangle({std::round(left), middle - std::floor(thickness / 2)},
                   std::round(cell.bar->pixels), thickness, ink);
  canvas.text({left + cell.bar->pixels + layout.text / 2, bottom}, cell.bar->text, layout.text,
              ink);
}

}  // namespace

Picture pictureSheet(const std::vector<PicturePanel>& panels,
                     const std::optional<VoxelSize>& voxelSize, const Rgb& background,
                     const Rgb& ink) {
  double area = 0;
  for (const PicturePanel& panel : panels)
    area = std::max(area, double(panel.picture.width) * panel.picture.height);
  Layout layout;
  layout.text = std::max(10.0, std::sqrt(area) / 36);
  layout.gap = int(std::lround(1.2 * layout.text));
  layout.line = int(std::lround(1.5 * layout.text));
  const std::vector<Cell> cells = cellsOf(panels, voxelSize, layout);
  for (const Cell& cell : cells)
    if (cell.bar && cell.captionWidth + 2 * layout.text + cell.barWidth > cell.panel.picture.width)
      layout.lines = cell.captionWidth > 0 ? 2 : layout.lines;
  layout = bestLayout(cells, layout);

  Picture whole(layout.width(), layout.height(), background);
  const int thickness = std::max(1, int(std::lround(layout.text / 16)));
  const size_t columns = layout.widths.size();
  int top = layout.gap;
  for (size_t row = 0; row < layout.heights.size(); ++row) {
    int left = layout.gap;
    for (size_t i = row * columns; i < std::min(cells.size(), (row + 1) * columns); ++i) {
      const Picture& picture = cells[i].panel.picture;
      const int below = top + layout.heights[row];
      copy(picture, left, below - picture.height, whole);
      if (cells[i].panel.framed) frame(picture, left, below - picture.height, thickness, whole);
      detail::paint(whole, left, below + thickness, layout.widths[i % columns],
                    layout.lines * layout.line,
                    [&](Canvas& canvas) { drawBelow(cells[i], layout, ink, canvas); });
      left += layout.widths[i % columns] + layout.gap;
    }
    top += layout.heights[row] + layout.lines * layout.line + layout.gap;
  }
  return whole;
}

}  // namespace vdb_madf
