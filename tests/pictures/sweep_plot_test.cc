// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/pictures/sweep_plot.h"

#include <string>

#include "support/catch.h"

using namespace vdb_madf;

namespace {

// Lines of the first and the second color.
const std::string kBlue = "stroke:rgb(0%,44.705882%,69.803922%)";
const std::string kOrange = "stroke:rgb(83.529412%,36.862745%,0%)";

int occurrences(const std::string& text, const std::string& what) {
  int found = 0;
  for (size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + 1)) ++found;
  return found;
}

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
  CHECK(occurrences(svg, "<svg ") == 1);
  CHECK(occurrences(svg, "</svg>") == 1);
  // A line a diagram and one in the legend, of two gammas and two modes each.
  CHECK(occurrences(svg, kBlue) == 4 * 2);
  CHECK(occurrences(svg, kOrange) == 4 * 2);
  CHECK(occurrences(svg, "stroke-dasharray:2,3") == 4 * 2);
}

TEST_CASE("sweep_plot: zeros have no place on a logarithmic axis", "[sweep_plot]") {
  const std::string svg = sweepPlot({SweepRow()}, 100);
  CHECK(occurrences(svg, kBlue) == 1);  // in the legend: a point is no line
  CHECK(occurrences(svg, "nan") == 0);
  CHECK(occurrences(svg, "inf") == 0);
  CHECK(occurrences(sweepPlot({}, 100), kBlue) == 0);
}
