// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/pictures/sweep_plot.h"

#include <algorithm>
#include <functional>
#include <string>

#include "vdb_madf/pictures/detail/diagram.h"
#include "vdb_madf/segmentation/segmentation_metadata.h"

namespace vdb_madf {

namespace {

using detail::Canvas;
using detail::Point;

// Pixels of the drawing.
constexpr double kDiagramWidth = 360, kDiagramHeight = 260, kLeft = 64, kDiagramTop = 34,
                 kDiagramStep = kLeft + kDiagramWidth + 14;
constexpr double kBelowDiagram = 46, kLegendRow = 18, kLegendColumn = 230;

struct Line {
  int64_t gamma = 0;
  MergeMode mode = MergeMode::score;
  int delta = 0;
  detail::Pen pen;
  std::vector<SweepRow> rows;  ///< by theta, or strictness
};

bool isByScore(const Line& line) {
  return line.mode == MergeMode::score;
}
double sweptOf(const SweepRow& row) {
  return row.mode == MergeMode::score ? row.strictness : row.theta;
}

/// Rows of equal gamma, mode and delta follow each other.
std::vector<Line> linesOf(const std::vector<SweepRow>& rows) {
  std::vector<Line> lines;
  std::vector<int64_t> gammas;
  std::vector<int> deltas;
  for (const SweepRow& row : rows) {
    if (lines.empty() || lines.back().gamma != row.gamma || lines.back().mode != row.mode ||
        lines.back().delta != row.delta) {
      if (gammas.empty() || gammas.back() != row.gamma) gammas.push_back(row.gamma);
      auto delta = std::find(deltas.begin(), deltas.end(), row.delta);
      if (delta == deltas.end()) delta = deltas.insert(delta, row.delta);
      const std::vector<double> dashes = row.mode == MergeMode::angle  ? std::vector<double>{7, 4}
                                         : row.mode == MergeMode::neck ? std::vector<double>{2, 3}
                                                                       : std::vector<double>{};
      const Rgb color = detail::kPlotColors[(gammas.size() - 1) % detail::kPlotColors.size()];
      lines.push_back({row.gamma,
                       row.mode,
                       row.delta,
                       {color, 2 + double(delta - deltas.begin()), dashes},
                       {}});
    }
    lines.back().rows.push_back(row);
  }
  for (Line& line : lines)
    std::sort(line.rows.begin(), line.rows.end(),
              [](const SweepRow& a, const SweepRow& b) { return sweptOf(a) < sweptOf(b); });
  return lines;
}

using ValueOf = std::function<double(const SweepRow&)>;

void drawDiagram(Canvas& canvas, const std::vector<Line>& lines, double left,
                 const std::string& title, bool logarithmic, const ValueOf& valueOf) {
  std::vector<double> swept, values;
  for (const Line& line : lines)
    for (const SweepRow& row : line.rows) {
      swept.push_back(sweptOf(row));
      values.push_back(valueOf(row));
    }
  if (!logarithmic) values.insert(values.end(), {0.0, 1.0});
  const detail::DiagramFrame frame{left, kDiagramTop, kDiagramWidth, kDiagramHeight};
  const detail::PlotAxis x(swept, false, left, left + kDiagramWidth),
      y(values, logarithmic, kDiagramTop + kDiagramHeight, kDiagramTop);
  const bool byScore = !lines.empty() && isByScore(lines.front());
  detail::drawDiagramFrame(canvas, frame, x, y, byScore ? "strictness" : "theta", title);
  for (const Line& line : lines) {
    std::vector<Point> points;
    for (const SweepRow& row : line.rows)
      if (y.shows(valueOf(row))) points.push_back({x(sweptOf(row)), y(valueOf(row))});
    canvas.line(points, line.pen);
  }
}

}  // namespace

std::string sweepPlot(const std::vector<SweepRow>& rows, int64_t smallVoxels, PlotType type) {
  const std::vector<Line> lines = linesOf(rows);
  const auto columns = size_t((3 * kDiagramStep) / kLegendColumn);
  const size_t legendRows = (lines.size() + columns - 1) / columns;
  const double width = 3 * kDiagramStep + 14,
               top = kDiagramTop + kDiagramHeight + kBelowDiagram + 10;
  const double height = top + double(legendRows) * kLegendRow + 8;
  const auto draw = [&](Canvas& canvas) {
    drawDiagram(canvas, lines, kLeft, "grains", true,
                [](const SweepRow& row) { return double(row.grains); });
    drawDiagram(canvas, lines, kLeft + kDiagramStep, "median size of a grain, voxels", true,
                [](const SweepRow& row) { return row.medianVoxels; });
    drawDiagram(canvas, lines, kLeft + 2 * kDiagramStep,
                "share of grains smaller than " + std::to_string(smallVoxels) + " voxels", false,
                [](const SweepRow& row) {
                  return row.grains ? double(row.smallGrains) / double(row.grains) : 0;
                });
    for (size_t i = 0; i < lines.size(); ++i) {
      const double x = kLeft + double(i % columns) * kLegendColumn;
      const double y = top + double(i / columns) * kLegendRow;
      canvas.line({{x, y}, {x + 34, y}}, lines[i].pen);
      canvas.text({x + 42, y + 4},
                  "gamma " + std::to_string(lines[i].gamma) + ", " + toString(lines[i].mode) +
                      (isByScore(lines[i]) ? "" : ", delta " + std::to_string(lines[i].delta)),
                  detail::kPlotText, detail::kPlotInk);
    }
  };
  return detail::plotFile(type, width, height, draw);
}

}  // namespace vdb_madf
