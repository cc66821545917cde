// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/pictures/detail/diagram.h"

#include <cmath>
#include <cstdint>

namespace vdb_madf::detail {

namespace {

/// Drops what is left of 0.1 + 0.2, and writes 12 000 000 rather than 1.2e+07.
std::string tickText(double tick) {
  constexpr double kLargest = 1e12;
  if (std::abs(tick) < 1e4 || std::abs(tick) >= kLargest || tick != std::floor(tick))
    return plotNumber(std::round(tick * 1e9) / 1e9);
  std::string digits = std::to_string(int64_t(tick));
  for (int at = int(digits.size()) - 3; at > (tick < 0); at -= 3) digits.insert(size_t(at), " ");
  return digits;
}

}  // namespace

void drawDiagramFrame(Canvas& canvas, const DiagramFrame& frame, const PlotAxis& x,
                      const PlotAxis& y, const std::string& nameOfX, const std::string& nameOfY) {
  const Pen grid{kPlotGrid, 1}, axis{kPlotInk, 1};
  const double right = frame.left + frame.width, bottom = frame.top + frame.height;
  for (const double tick : x.ticks()) {
    canvas.line({{x(tick), frame.top}, {x(tick), bottom}}, grid);
    canvas.text({x(tick), bottom + 16}, tickText(tick), kPlotText, kPlotInk, Anchor::middle);
  }
  for (const double tick : y.ticks()) {
    canvas.line({{frame.left, y(tick)}, {right, y(tick)}}, grid);
    canvas.text({frame.left - 6, y(tick) + 4}, tickText(tick), kPlotText, kPlotInk, Anchor::end);
  }
  canvas.line({{frame.left, frame.top}, {frame.left, bottom}, {right, bottom}}, axis);
  canvas.text({frame.left + frame.width / 2, bottom + 34}, nameOfX, kPlotText, kPlotInk,
              Anchor::middle);
  canvas.text({frame.left, frame.top - 12}, nameOfY, kPlotText + 1, kPlotInk);
}

}  // namespace vdb_madf::detail
