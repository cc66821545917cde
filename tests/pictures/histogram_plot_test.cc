// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/pictures/histogram_plot.h"

#include "support/catch.h"

using namespace vdb_madf;
using vdb_madf::test::Contains;

TEST_CASE("histogram_plot: a step a bin, and a line a mark", "[histogram_plot]") {
  const std::string svg = histogramPlot({0, 10, 4}, 0, 300, {{150, "otsu"}});
  CHECK_THAT(svg, Contains("<svg ") && Contains("</svg>"));
  // From the zero line over three steps and back; 10 voxels are the top of the axis.
  CHECK_THAT(svg, Contains("d=\"M 84 354 L 297.332031 354 L 297.332031 54 L 510.667969 54 "
                           "L 510.667969 234 L 724 234 L 724 354 \""));
  CHECK_THAT(svg, Contains("d=\"M 404 54 L 404 354 \""));
}

TEST_CASE("histogram_plot: one bin is enough", "[histogram_plot]") {
  CHECK_THAT(histogramPlot({3}, -1, 1, {}), Contains("</svg>") && !Contains("nan"));
}

TEST_CASE("histogram_plot: each type of file, with the same bytes each time", "[histogram_plot]") {
  for (const auto& [type, begin] : {std::pair<PlotType, std::string>{PlotType::png, "\x89PNG"},
                                    {PlotType::svg, "<?xml"},
                                    {PlotType::pdf, "%PDF"}}) {
    const auto plot = [&, as = type] { return histogramPlot({1, 2}, 0, 1, {{0.5, "µ"}}, as); };
    const std::string bytes = plot();
    CHECK(bytes.substr(0, begin.size()) == begin);
    const bool same = bytes == plot();
    CHECK(same);
    CHECK_THAT(bytes, !Contains("CreationDate"));
  }
}

TEST_CASE("histogram_plot: the ending of a file says its type", "[histogram_plot]") {
  CHECK(plotTypeOf("a.svg") == PlotType::svg);
  CHECK(plotTypeOf("b/a.PDF") == PlotType::pdf);
  CHECK(plotTypeOf("a.b.png") == PlotType::png);
  CHECK_FALSE(plotTypeOf("a.jpg"));
  CHECK_FALSE(plotTypeOf("svg"));
}
