// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/pictures/sweep_plot.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <sstream>

#include "vdb_madf/method/segmentation_metadata.h"
#include "vdb_madf/pictures/detail/plot_axis.h"

namespace vdb_madf {

namespace {

using detail::plotNumber;

// Pixels of the drawing.
constexpr double kWidth = 360, kHeight = 260, kLeft = 64, kTop = 34, kStep = kLeft + kWidth + 14;
constexpr double kBelow = 46, kLegendRow = 18, kLegendColumn = 230;

/// Okabe & Ito: told apart by colour-blind readers, too.
constexpr std::array<const char*, 7> kColors{"#0072B2", "#D55E00", "#009E73", "#CC79A7",
                                             "#E69F00", "#56B4E9", "#000000"};

struct Line {
  int64_t gamma = 0;
  MergeMode mode = MergeMode::both;
  int delta = 0;
  std::string style;
  std::vector<SweepRow> rows;  ///< by theta
};

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
      const char* dashes = row.mode == MergeMode::angle  ? " stroke-dasharray=\"7 4\""
                           : row.mode == MergeMode::neck ? " stroke-dasharray=\"2 3\""
                                                         : "";
      lines.push_back({row.gamma,
                       row.mode,
                       row.delta,
                       "fill=\"none\" stroke-width=\"" +
                           plotNumber(2 + double(delta - deltas.begin())) + "\" stroke=\"" +
                           kColors[(gammas.size() - 1) % kColors.size()] + "\"" + dashes,
                       {}});
    }
    lines.back().rows.push_back(row);
  }
  for (Line& line : lines)
    std::sort(line.rows.begin(), line.rows.end(),
              [](const SweepRow& a, const SweepRow& b) { return a.theta < b.theta; });
  return lines;
}

using ValueOf = std::function<double(const SweepRow&)>;

void drawDiagram(std::ostream& svg, const std::vector<Line>& lines, double left,
                 const std::string& title, bool logarithmic, const ValueOf& valueOf) {
  std::vector<double> thetas, values;
  for (const Line& line : lines)
    for (const SweepRow& row : line.rows) {
      thetas.push_back(row.theta);
      values.push_back(valueOf(row));
    }
  if (!logarithmic) values.insert(values.end(), {0.0, 1.0});
  const detail::PlotAxis x(thetas, false, left, left + kWidth),
      y(values, logarithmic, kTop + kHeight, kTop);

  svg << "<text x=\"" << left << "\" y=\"" << kTop - 12 << "\" font-weight=\"bold\">" << title
      << "</text>\n";
  for (const double tick : x.ticks())
    svg << "<path d=\"M" << plotNumber(x(tick)) << ' ' << kTop << "v" << kHeight
        << "\" stroke=\"#ddd\"/><text x=\"" << plotNumber(x(tick)) << "\" y=\""
        << kTop + kHeight + 16 << "\" text-anchor=\"middle\">"
        << plotNumber(std::round(tick * 1e9) / 1e9) << "</text>\n";
  for (const double tick : y.ticks())
    svg << "<path d=\"M" << left << ' ' << plotNumber(y(tick)) << "h" << kWidth
        << "\" stroke=\"#ddd\"/><text x=\"" << left - 6 << "\" y=\"" << plotNumber(y(tick) + 4)
        << "\" text-anchor=\"end\">" << plotNumber(std::round(tick * 1e9) / 1e9) << "</text>\n";
  svg << "<text x=\"" << left + kWidth / 2 << "\" y=\"" << kTop + kHeight + 34
      << "\" text-anchor=\"middle\">theta</text>\n";
  for (const Line& line : lines) {
    svg << "<polyline " << line.style << " points=\"";
    for (const SweepRow& row : line.rows)
      if (y.shows(valueOf(row)))
        svg << plotNumber(x(row.theta)) << ',' << plotNumber(y(valueOf(row))) << ' ';
    svg << "\"/>\n";
  }
}

}  // namespace

std::string sweepPlot(const std::vector<SweepRow>& rows, int64_t smallVoxels) {
  const std::vector<Line> lines = linesOf(rows);
  const auto columns = size_t((3 * kStep) / kLegendColumn);
  const size_t legendRows = (lines.size() + columns - 1) / columns;
  const double width = 3 * kStep + 14, top = kTop + kHeight + kBelow + 10;
  const double height = top + double(legendRows) * kLegendRow + 8;

  std::ostringstream svg;
  svg << "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"" << width << "\" height=\"" << height
      << "\" viewBox=\"0 0 " << width << ' ' << height
      << "\" font-family=\"sans-serif\" font-size=\"12\">\n"
      << "<rect width=\"" << width << "\" height=\"" << height << "\" fill=\"white\"/>\n";
  drawDiagram(svg, lines, kLeft, "grains", true,
              [](const SweepRow& row) { return double(row.grains); });
  drawDiagram(svg, lines, kLeft + kStep, "median size of a grain, voxels", true,
              [](const SweepRow& row) { return row.medianVoxels; });
  drawDiagram(svg, lines, kLeft + 2 * kStep,
              "share of grains smaller than " + std::to_string(smallVoxels) + " voxels", false,
              [](const SweepRow& row) {
                return row.grains ? double(row.smallGrains) / double(row.grains) : 0;
              });
  for (size_t i = 0; i < lines.size(); ++i) {
    const double x = kLeft + double(i % columns) * kLegendColumn;
    const double y = top + double(i / columns) * kLegendRow;
    svg << "<path " << lines[i].style << " d=\"M" << x << ' ' << y << "h34\"/><text x=\"" << x + 42
        << "\" y=\"" << y + 4 << "\">gamma " << lines[i].gamma << ", " << toString(lines[i].mode)
        << ", delta " << lines[i].delta << "</text>\n";
  }
  svg << "</svg>\n";
  return svg.str();
}

}  // namespace vdb_madf
