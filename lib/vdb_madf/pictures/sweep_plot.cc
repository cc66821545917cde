// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/pictures/sweep_plot.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <sstream>

#include "vdb_madf/method/segmentation_metadata.h"

namespace vdb_madf {

namespace {

// Pixels of the drawing.
constexpr double kWidth = 360, kHeight = 260, kLeft = 64, kTop = 34, kStep = kLeft + kWidth + 14;
constexpr double kBelow = 46, kLegendRow = 18, kLegendColumn = 230;

/// Okabe & Ito: told apart by colour-blind readers, too.
constexpr std::array<const char*, 7> kColors{"#0072B2", "#D55E00", "#009E73", "#CC79A7",
                                             "#E69F00", "#56B4E9", "#000000"};

std::string number(double value) {
  std::ostringstream text;
  text.precision(6);
  text << value;
  return text.str();
}

/// From values to pixels, and where its ticks are.
class Axis {
 public:
  Axis(std::vector<double> values, bool logarithmic, double begin, double end)
      : logarithmic_(logarithmic), begin_(begin), end_(end) {
    values.erase(std::remove_if(values.begin(), values.end(), [&](double v) { return !shows(v); }),
                 values.end());
    if (values.empty()) values = {1};
    low_ = scaled(*std::min_element(values.begin(), values.end()));
    high_ = scaled(*std::max_element(values.begin(), values.end()));
    if (logarithmic_) {
      placeDecades();
    } else {
      placeEvenly();
    }
  }
  bool shows(double value) const { return !logarithmic_ || value > 0; }
  double operator()(double value) const {
    return begin_ + (scaled(value) - low_) / (high_ - low_) * (end_ - begin_);
  }
  const std::vector<double>& ticks() const { return ticks_; }

 private:
  double scaled(double value) const { return logarithmic_ ? std::log10(value) : value; }

  /// 1, 2 and 5 times powers of ten (1 alone if these are many); the axis ends at ticks.
  void placeDecades() {
    const bool few = high_ - low_ < 3;
    std::vector<double> all;
    for (int decade = int(std::floor(low_)); decade <= int(std::ceil(high_)) + 1; ++decade)
      for (const int digit : {1, 2, 5})
        if (few || digit == 1) all.push_back(digit * std::pow(10.0, decade));
    size_t first = 0, last = 1;
    while (first + 1 < all.size() && std::log10(all[first + 1]) <= low_ + 1e-9) ++first;
    while (last + 1 < all.size() && (std::log10(all[last]) < high_ - 1e-9 || last <= first)) ++last;
    ticks_.assign(all.begin() + std::ptrdiff_t(first), all.begin() + std::ptrdiff_t(last) + 1);
    low_ = std::log10(ticks_.front());
    high_ = std::log10(ticks_.back());
  }

  /// Multiples of 1, 2 or 5 times a power of ten; the axis ends at ticks.
  void placeEvenly() {
    if (!(high_ > low_)) high_ = low_ + (low_ == 0 ? 1 : std::abs(low_) * 0.1);
    double step = std::pow(10.0, std::floor(std::log10((high_ - low_) / 5)));
    for (const double factor : {2.0, 2.5, 2.0})
      if ((high_ - low_) / step > 6) step *= factor;
    const double first = std::floor(low_ / step + 1e-9), last = std::ceil(high_ / step - 1e-9);
    for (double k = first; k <= last; ++k) ticks_.push_back(k * step);
    low_ = ticks_.front();
    high_ = ticks_.back();
  }

  bool logarithmic_;
  double begin_, end_, low_ = 0, high_ = 1;
  std::vector<double> ticks_;
};

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
                           number(2 + double(delta - deltas.begin())) + "\" stroke=\"" +
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
  const Axis x(thetas, false, left, left + kWidth), y(values, logarithmic, kTop + kHeight, kTop);

  svg << "<text x=\"" << left << "\" y=\"" << kTop - 12 << "\" font-weight=\"bold\">" << title
      << "</text>\n";
  for (const double tick : x.ticks())
    svg << "<path d=\"M" << number(x(tick)) << ' ' << kTop << "v" << kHeight
        << "\" stroke=\"#ddd\"/><text x=\"" << number(x(tick)) << "\" y=\"" << kTop + kHeight + 16
        << "\" text-anchor=\"middle\">" << number(std::round(tick * 1e9) / 1e9) << "</text>\n";
  for (const double tick : y.ticks())
    svg << "<path d=\"M" << left << ' ' << number(y(tick)) << "h" << kWidth
        << "\" stroke=\"#ddd\"/><text x=\"" << left - 6 << "\" y=\"" << number(y(tick) + 4)
        << "\" text-anchor=\"end\">" << number(std::round(tick * 1e9) / 1e9) << "</text>\n";
  svg << "<text x=\"" << left + kWidth / 2 << "\" y=\"" << kTop + kHeight + 34
      << "\" text-anchor=\"middle\">theta</text>\n";
  for (const Line& line : lines) {
    svg << "<polyline " << line.style << " points=\"";
    for (const SweepRow& row : line.rows)
      if (y.shows(valueOf(row)))
        svg << number(x(row.theta)) << ',' << number(y(valueOf(row))) << ' ';
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
