// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/pictures/histogram_plot.h"

#include <algorithm>
#include <sstream>

#include "vdb_madf/pictures/detail/plot_axis.h"

namespace vdb_madf {

namespace {

using detail::plotNumber;

// Pixels of the drawing.
constexpr double kWidth = 640, kHeight = 300, kLeft = 84, kTop = 40, kRight = 24, kBelow = 46;

}  // namespace

std::string histogramPlot(const std::vector<double>& counts, double low, double high,
                          const std::vector<PlotMark>& marks) {
  const double most = *std::max_element(counts.begin(), counts.end());
  const detail::PlotAxis x({low, high}, false, kLeft, kLeft + kWidth);
  const detail::PlotAxis y({0, most}, false, kTop + kHeight, kTop);
  const double width = kLeft + kWidth + kRight, height = kTop + kHeight + kBelow;
  std::ostringstream svg;
  svg << "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"" << width << "\" height=\"" << height
      << "\" viewBox=\"0 0 " << width << ' ' << height
      << "\" font-family=\"sans-serif\" font-size=\"12\">\n"
      << "<rect width=\"" << width << "\" height=\"" << height << "\" fill=\"white\"/>\n";
  for (const double tick : x.ticks())
    svg << "<path d=\"M" << plotNumber(x(tick)) << ' ' << kTop << "v" << kHeight
        << "\" stroke=\"#ddd\"/><text x=\"" << plotNumber(x(tick)) << "\" y=\""
        << kTop + kHeight + 16 << "\" text-anchor=\"middle\">" << plotNumber(tick) << "</text>\n";
  for (const double tick : y.ticks())
    svg << "<path d=\"M" << kLeft << ' ' << plotNumber(y(tick)) << "h" << kWidth
        << "\" stroke=\"#ddd\"/><text x=\"" << kLeft - 6 << "\" y=\"" << plotNumber(y(tick) + 4)
        << "\" text-anchor=\"end\">" << plotNumber(tick) << "</text>\n";
  svg << "<text x=\"" << kLeft + kWidth / 2 << "\" y=\"" << kTop + kHeight + 34
      << "\" text-anchor=\"middle\">value</text>\n<text x=\"" << kLeft << "\" y=\"" << kTop - 22
      << "\" font-weight=\"bold\">voxels</text>\n";
  const double bin = (high - low) / double(counts.size());
  svg << "<path fill=\"#56B4E9\" d=\"M" << plotNumber(x(low)) << ' ' << plotNumber(y(0));
  for (size_t i = 0; i < counts.size(); ++i)
    svg << 'V' << plotNumber(y(counts[i])) << 'H' << plotNumber(x(low + double(i + 1) * bin));
  svg << 'V' << plotNumber(y(0)) << "z\"/>\n";
  for (size_t i = 0; i < marks.size(); ++i)
    svg << "<path d=\"M" << plotNumber(x(marks[i].value)) << ' ' << kTop << "v" << kHeight
        << "\" stroke=\"#D55E00\" stroke-width=\"2\"/><text x=\"" << plotNumber(x(marks[i].value))
        << "\" y=\"" << kTop - 6 - 14 * double(i) << "\" text-anchor=\"middle\">" << marks[i].name
        << ' ' << plotNumber(marks[i].value) << "</text>\n";
  svg << "</svg>\n";
  return svg.str();
}

}  // namespace vdb_madf
