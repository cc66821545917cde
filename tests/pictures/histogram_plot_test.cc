// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/pictures/histogram_plot.h"

#include <catch2/catch.hpp>

using namespace vdb_madf;
using Catch::Matchers::Contains;

TEST_CASE("histogram_plot: a step a bin, and a line a mark", "[histogram_plot]") {
  const std::string svg = histogramPlot({0, 10, 4}, 0, 300, {{150, "otsu"}});
  CHECK(svg.rfind("<svg ", 0) == 0);
  CHECK_THAT(svg, Contains("</svg>"));
  // From the zero line over three steps and back; 10 voxels are the top of the axis.
  CHECK_THAT(svg, Contains("d=\"M84 340V340H297.333V40H510.667V220H724V340z\""));
  CHECK_THAT(svg, Contains("M404 40v300") && Contains(">otsu 150<"));
}

TEST_CASE("histogram_plot: one bin is enough", "[histogram_plot]") {
  CHECK_THAT(histogramPlot({3}, -1, 1, {}), Contains("z\"/>") && !Contains("nan"));
}
