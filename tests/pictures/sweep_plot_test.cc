// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/pictures/sweep_plot.h"

#include <string>

#include "support/catch.h"
#include "support/svg.h"

using namespace vdb_madf;
using test::countInSvg;

namespace {

// Lines of the first and the second color.
const std::string kBlue = "stroke:rgb(0%,44.705882%,69.803922%)";
const std::string kOrange = "stroke:rgb(83.529412%,36.862745%,0%)";

}  // namespace

TEST_CASE("sweep_plot: a line a gamma and mode in each of three diagrams", "[sweep_plot]") {
  std::vector<SweepRow> rows;
  for (const int64_t gamma : {0, 20})
    for (const MergeMode mode : {MergeMode::both, MergeMode::neck})
      for (const double theta : {-0.9, -1.0, -0.5}) {
        SweepRow row;
        row.gamma = gamma;
        row.mode = mode;
        row.theta = theta;
        row.delta = 2;
        row.grains = 100 + gamma;
        row.medianVoxels = 50;
        rows.push_back(row);
      }
  const std::string svg = sweepPlot(rows, 123);
  CHECK(countInSvg(svg, "<svg ") == 1);
  CHECK(countInSvg(svg, "</svg>") == 1);
  // A line a diagram and one in the legend, of two gammas and two modes each.
  CHECK(countInSvg(svg, kBlue) == 4 * 2);
  CHECK(countInSvg(svg, kOrange) == 4 * 2);
  CHECK(countInSvg(svg, "stroke-dasharray:2,3") == 4 * 2);
}

TEST_CASE("sweep_plot: zeros have no place on a logarithmic axis", "[sweep_plot]") {
  const std::string svg = sweepPlot({SweepRow()}, 100);
  CHECK(countInSvg(svg, kBlue) == 1);  // in the legend: a point is no line
  CHECK(countInSvg(svg, "nan") == 0);
  CHECK(countInSvg(svg, "inf") == 0);
  CHECK(countInSvg(sweepPlot({}, 100), kBlue) == 0);
}
