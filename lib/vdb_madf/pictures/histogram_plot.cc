// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/pictures/histogram_plot.h"

#include <algorithm>

#include "vdb_madf/pictures/detail/diagram.h"

namespace vdb_madf {

namespace {

using detail::Anchor;
using detail::Canvas;
using detail::Point;

constexpr detail::DiagramFrame kFrame{84, 54, 640, 300};
constexpr double kRight = 24, kBelow = 46;

}  // namespace

std::string histogramPlot(const std::vector<double>& counts, double low, double high,
                          const std::vector<PlotMark>& marks, PlotType type) {
  const double most = *std::max_element(counts.begin(), counts.end());
  const detail::PlotAxis x({low, high}, false, kFrame.left, kFrame.left + kFrame.width);
  const detail::PlotAxis y({0, most}, false, kFrame.top + kFrame.height, kFrame.top);
  const auto draw = [&](Canvas& canvas) {
    detail::drawDiagramFrame(canvas, kFrame, x, y, "value", "voxels");
    const double bin = (high - low) / double(counts.size());
    std::vector<Point> outline{{x(low), y(0)}};
    for (size_t i = 0; i < counts.size(); ++i) {
      outline.push_back({x(low + double(i) * bin), y(counts[i])});
      outline.push_back({x(low + double(i + 1) * bin), y(counts[i])});
    }
    outline.push_back({x(high), y(0)});
    canvas.area(outline, detail::kPlotColors[5]);
    for (size_t i = 0; i < marks.size(); ++i) {
      const double at = x(marks[i].value);
      canvas.line({{at, kFrame.top}, {at, kFrame.top + kFrame.height}},
                  {detail::kPlotColors[1], 2});
      canvas.text({at, kFrame.top - 8 - 15 * double(i)},
                  marks[i].name + " " + detail::plotNumber(marks[i].value), detail::kPlotText,
                  detail::kPlotInk, Anchor::middle);
    }
  };
  return detail::plotFile(type, kFrame.left + kFrame.width + kRight,
                          kFrame.top + kFrame.height + kBelow, draw);
}

}  // namespace vdb_madf
