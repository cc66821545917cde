// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/pictures/measures_plot.h"

#include <string>

#include "support/catch.h"
#include "support/svg.h"

using namespace vdb_madf;

namespace {

const std::string kBar = "fill:rgb(0%,44.705882%,69.803922%)",
                  kSector = "fill:rgb(83.529412%,36.862745%,0%)";

/// Whole grains of diameters 1, 2 ... along z, one that is cut, and bonds along x.
Measurements measured(int grains, int bonds) {
  Measurements m;
  m.open = true;
  for (int i = 0; i <= grains; ++i) {
    GrainMeasures grain;
    grain.id = i + 1;
    grain.atDomainFace = i == grains;
    grain.equivalentDiameter = i + 1;
    grain.volume = 1;
    grain.sphericity = 0.8;
    grain.coordination = i % 3;
    grain.ellipsoid.axes[0] = openvdb::Vec3d(0, 0, 1);
    m.grains.push_back(grain);
  }
  for (int i = 0; i < bonds; ++i) {
    BondMeasures bond;
    bond.equivalentRadius = 2;
    bond.area = 4;
    bond.normal = openvdb::Vec3d(1, 0, 0);
    m.bonds.push_back(bond);
  }
  return m;
}

}  // namespace

TEST_CASE("measures_plot: a bar a bin and a sector a direction", "[measures_plot]") {
  const std::string svg = measuresPlot(measured(27, 5), "sample");
  // Six bins of diameters by Rice's rule, in two histograms; one of equal sphericities and of equal
  // radii each; three numbers of bonds.
  CHECK(test::countInSvg(svg, kBar) == 6 + 6 + 1 + 3 + 1);
  // Along x: one and its opposite; across z, and along it: one in each quarter.
  CHECK(test::countInSvg(svg, kSector) == 2 + 4 + 4);
  CHECK(svg.find("nan") == std::string::npos);
  CHECK(svg.find("inf") == std::string::npos);
}

TEST_CASE("measures_plot: grains that are cut do not count", "[measures_plot]") {
  Measurements m = measured(27, 5);
  const std::string whole = measuresPlot(m, "");
  m.grains.back().equivalentDiameter = 1000;
  CHECK((measuresPlot(m, "") == whole));
  m.open = false;  // then no face cuts any
  CHECK((measuresPlot(m, "") != whole));
  m.open = true;
  m.grains.front().equivalentDiameter = 1000;
  CHECK((measuresPlot(m, "") != whole));
}

TEST_CASE("measures_plot: large bonds count for more in the roses", "[measures_plot]") {
  Measurements m = measured(3, 2);
  m.bonds[1].normal = openvdb::Vec3d(0, 1, 0);
  const std::string equal = measuresPlot(m, "");
  m.bonds[1].area *= 2;
  CHECK((measuresPlot(m, "") != equal));
  m.bonds[0].area *= 2;
  CHECK((measuresPlot(m, "") == equal));
  m.bonds[0].normal = openvdb::Vec3d(-1, 0, 0);  // directions are axial
  CHECK((measuresPlot(m, "") == equal));
}

TEST_CASE("measures_plot: nothing to plot, and the title", "[measures_plot]") {
  const std::string none = measuresPlot({}, "");
  CHECK(test::countInSvg(none, kBar) == 0);
  CHECK(none.find("nan") == std::string::npos);
  CHECK((measuresPlot({}, "a <b> & µ") != none));
  CHECK(measuresPlot(measured(1, 0), "", PlotType::pdf).substr(0, 4) == "%PDF");
}
