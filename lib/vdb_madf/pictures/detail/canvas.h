// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <array>
#include <functional>
#include <string>
#include <vector>

#include "vdb_madf/pictures/picture.h"
#include "vdb_madf/pictures/plot_type.h"

typedef struct _cairo cairo_t;  // NOLINT: as cairo.h says it

namespace vdb_madf::detail {

using Point = std::array<double, 2>;  ///< to the right, down

struct Pen {
  Rgb color{};
  double width = 1;
  std::vector<double> dashes = {};  ///< lengths drawn and left out; none: all is drawn
};

enum class Anchor { start, middle, end };

/// Lines, areas and text, antialiased, in pixels of a picture or in points of a document. Text is
/// UTF-8 in the library's own font, Open Sans, without hints: of the same shape in all sizes.
class Canvas {
 public:
  explicit Canvas(cairo_t* context) : context_(context) {}

  /// All that follows is drawn so many times as large.
  void scale(double factor);
  /// Nothing, for fewer than two points.
  void line(const std::vector<Point>& points, const Pen& pen);
  void area(const std::vector<Point>& corners, const Rgb& color);
  void rectangle(const Point& corner, double width, double height, const Rgb& color);
  /// @param at the anchor on the base line; @param size of the font
  void text(const Point& at, const std::string& text, double size, const Rgb& color,
            Anchor anchor = Anchor::start);

 private:
  void path(const std::vector<Point>& points);
  void color(const Rgb& color);

  cairo_t* context_;
};

using Drawing = std::function<void(Canvas&)>;

/// How far the text goes, in the unit of `size`.
double textWidth(const std::string& text, double size);

/// Draws on the part of a picture whose upper left corner is (left, top), which is the canvas's
/// origin; what lies outside of the part or of the picture is cut off.
void paint(Picture& picture, int left, int top, int width, int height, const Drawing& drawing);

/// The bytes of a file: the drawing on white, in units of 1/96 inch (PNG: at 300 dpi). The same
/// each time: no dates.
std::string plotFile(PlotType type, double width, double height, const Drawing& drawing);

}  // namespace vdb_madf::detail
