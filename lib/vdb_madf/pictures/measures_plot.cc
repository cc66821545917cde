// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/pictures/measures_plot.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "vdb_madf/base/counted.h"
#include "vdb_madf/measure/table_unit.h"
#include "vdb_madf/pictures/detail/diagram.h"

namespace vdb_madf {

namespace {

using detail::Anchor;
using detail::Canvas;
using detail::Point;

constexpr double kCellWidth = 300, kCellHeight = 270, kTop = 44;
constexpr int kColumns = 4;
constexpr Rgb kBars{0, 114, 178}, kSectors{213, 94, 0}, kWhite{255, 255, 255};

/// Numbers with what each counts.
struct Weighted {
  std::vector<double> values, weights;

  void add(double value, double weight) {
    values.push_back(value);
    weights.push_back(weight);
  }
};

struct Bins {
  double low = 0, width = 1;
  std::vector<double> heights;
};

/// Equal bins from the least to the largest value, by Rice's rule; of whole numbers one each.
Bins binned(const Weighted& data, bool whole) {
  const auto [least, largest] = std::minmax_element(data.values.begin(), data.values.end());
  Bins bins;
  int count = 0;
  if (whole) {
    bins.low = *least - 0.5;
    count = int(*largest - *least) + 1;
  } else {
    count = std::clamp(int(std::lround(2 * std::cbrt(double(data.values.size())))), 5, 40);
    const double range = *largest - *least;
    bins.width = range > 0 ? range / count : std::max(std::abs(*least), 1e-9) / count;
    bins.low = range > 0 ? *least : *least - bins.width * count / 2;
  }
  bins.heights.assign(size_t(count), 0);
  for (size_t i = 0; i < data.values.size(); ++i) {
    const int bin = std::clamp(int((data.values[i] - bins.low) / bins.width), 0, count - 1);
    bins.heights[size_t(bin)] += data.weights[i];
  }
  return bins;
}

/// Where a plot stands: the n-th cell.
Point cornerOf(int cell) {
  return {(cell % kColumns) * kCellWidth, kTop + (cell / kColumns) * kCellHeight};
}

void drawHistogram(Canvas& canvas, int cell, const Weighted& data, const std::string& nameOfX,
                   const std::string& nameOfY, bool whole = false) {
  const Point corner = cornerOf(cell);
  const detail::DiagramFrame frame{corner[0] + 58, corner[1] + 34, kCellWidth - 78,
                                   kCellHeight - 90};
  const Bins bins = data.values.empty() ? Bins{0, 1, {0}} : binned(data, whole);
  const auto count = double(bins.heights.size());
  const double most = *std::max_element(bins.heights.begin(), bins.heights.end());
  const detail::PlotAxis x({bins.low, bins.low + count * bins.width}, false, frame.left,
                           frame.left + frame.width, whole);
  const detail::PlotAxis y({0, most}, false, frame.top + frame.height, frame.top);
  detail::drawDiagramFrame(canvas, frame, x, y, nameOfX, nameOfY);
  for (size_t i = 0; i < bins.heights.size(); ++i) {
    const double left = x(bins.low + double(i) * bins.width),
                 right = x(bins.low + double(i + 1) * bins.width), top = y(bins.heights[i]);
    if (bins.heights[i] > 0)
      canvas.rectangle({left, top}, right - left - std::min(1.0, (right - left) / 4),
                       y(0) - top - 0.5, kBars);
  }
}

/// Densities of equal sectors of a whole turn, from `begin` on (radians, counterclockwise from the
/// right), and the names of the directions to the right and up.
void drawRose(Canvas& canvas, int cell, const std::vector<double>& densities, double begin,
              const std::string& title, const std::string& right, const std::string& up) {
  const Point corner = cornerOf(cell);
  const Point center{corner[0] + kCellWidth / 2, corner[1] + kCellHeight / 2 + 4};
  const double room = kCellHeight / 2 - 46;
  const double unit = room / std::max(1.25, *std::max_element(densities.begin(), densities.end()));
  const auto at = [&](double angle, double radius) {
    return Point{center[0] + radius * std::cos(angle), center[1] - radius * std::sin(angle)};
  };
  const double step = 2 * M_PI / double(densities.size());
  constexpr int kParts = 6;  // of an arc
  for (size_t i = 0; i < densities.size(); ++i) {
    std::vector<Point> sector{center};
    for (int k = 0; k <= kParts; ++k)
      sector.push_back(at(begin + (double(i) + double(k) / kParts) * step, densities[i] * unit));
    sector.push_back(center);
    canvas.area(sector, kSectors);
    canvas.line(sector, {kWhite, 0.5});
  }
  std::vector<Point> circle;
  for (int k = 0; k <= 90; ++k) circle.push_back(at(2 * M_PI * k / 90, unit));
  canvas.line(circle, {detail::kPlotInk, 1, {4, 3}});
  canvas.text({center[0], corner[1] + 22}, title, detail::kPlotText + 1, detail::kPlotInk,
              Anchor::middle);
  canvas.text(at(0, room + 4), right, detail::kPlotText, detail::kPlotInk);
  canvas.text(at(M_PI / 2, room + 6), up, detail::kPlotText, detail::kPlotInk, Anchor::middle);
}

using Directions = std::vector<std::pair<openvdb::Vec3d, double>>;  ///< with what each counts

/// A rose in the x-y plane: each direction counts with its shadow's length there. The axes lie in
/// the middle of their sectors.
void drawAzimuths(Canvas& canvas, int cell, const Directions& directions,
                  const std::string& title) {
  constexpr int kHalf = 18;
  const double step = M_PI / kHalf;
  std::vector<double> densities(2 * kHalf, 0);
  double total = 0;
  for (const auto& [n, weight] : directions) {
    const double shadow = weight * std::hypot(n.x(), n.y());
    const double turn = std::atan2(n.y(), n.x()) / step + 0.5;
    densities[size_t((int(std::floor(turn)) % kHalf + kHalf) % kHalf)] += shadow;
    total += shadow;
  }
  for (int i = 0; i < kHalf; ++i) {
    densities[size_t(i)] *= total > 0 ? kHalf / total : 0;
    densities[size_t(i + kHalf)] = densities[size_t(i)];
  }
  drawRose(canvas, cell, densities, -step / 2, title, "x", "y");
}

/// Angles to z, against what an isotropic sample has in each sector; the same in all quarters.
void drawInclinations(Canvas& canvas, int cell, const Directions& directions,
                      const std::string& title) {
  constexpr int kQuarter = 9;
  const double step = M_PI / 2 / kQuarter;
  std::vector<double> quarter(kQuarter, 0);  // from z on
  double total = 0;
  for (const auto& [n, weight] : directions) {
    const double angle = std::atan2(std::hypot(n.x(), n.y()), std::abs(n.z()));
    quarter[size_t(std::min(kQuarter - 1, int(angle / step)))] += weight;
    total += weight;
  }
  for (int k = 0; k < kQuarter; ++k)
    quarter[size_t(k)] *=
        total > 0 ? 1 / (total * (std::cos(k * step) - std::cos((k + 1) * step))) : 0;
  std::vector<double> densities(quarter.rbegin(), quarter.rend());  // from the right up to z
  densities.insert(densities.end(), quarter.begin(), quarter.end());
  const std::vector<double> half = densities;
  densities.insert(densities.end(), half.begin(), half.end());
  drawRose(canvas, cell, densities, 0, title, "", "z");
}

}  // namespace

std::string measuresPlot(const Measurements& m, const std::string& title, PlotType type,
                         const std::string& wanted) {
  const TableUnit own(m, wanted);
  const double length = own.length;
  const std::string unit = own.name == "voxel" ? "voxels" : own.name;
  Weighted diameters, volumes, sphericities, coordinations, radii;
  Directions axes, normals;
  const auto isCut = [&](const GrainMeasures& grain) { return m.open && grain.atDomainFace; };
  double volume = 0;
  for (const GrainMeasures& grain : m.grains)
    if (!isCut(grain)) volume += grain.volume;
  for (const GrainMeasures& grain : m.grains) {
    if (isCut(grain)) continue;
    diameters.add(length * grain.equivalentDiameter, 1);
    volumes.add(length * grain.equivalentDiameter, grain.volume / volume);
    if (grain.sphericity) sphericities.add(*grain.sphericity, 1);
    coordinations.add(grain.coordination, 1);
    axes.emplace_back(grain.ellipsoid.axes[0], grain.volume);
  }
  for (const BondMeasures& bond : m.bonds) {
    radii.add(length * bond.equivalentRadius, 1);
    normals.emplace_back(bond.normal, bond.area);
  }
  const std::string heading =
      (title.empty() ? "" : title + ": ") + counted(diameters.values.size(), "whole grain") +
      " of " + std::to_string(m.grains.size()) + ", " + counted(m.bonds.size(), "bond");
  const auto draw = [&](Canvas& canvas) {
    canvas.text({kColumns * kCellWidth / 2, 28}, heading, 16, detail::kPlotInk, Anchor::middle);
    const std::string diameter = "grain diameter, equal volume (" + unit + ")";
    drawHistogram(canvas, 0, diameters, diameter, "grains");
    drawHistogram(canvas, 1, volumes, diameter, "share of volume");
    drawHistogram(canvas, 2, sphericities, "sphericity", "grains");
    drawHistogram(canvas, 3, coordinations, "bonds of a grain", "grains", true);
    drawHistogram(canvas, 4, radii, "bond radius, equal area (" + unit + ")", "bonds");
    drawAzimuths(canvas, 5, normals, "bond normals, x-y");
    drawInclinations(canvas, 6, normals, "bond normals, angle to z");
    drawInclinations(canvas, 7, axes, "long axes of grains, angle to z");
  };
  return detail::plotFile(type, kColumns * kCellWidth, kTop + 2 * kCellHeight, draw);
}

}  // namespace vdb_madf
