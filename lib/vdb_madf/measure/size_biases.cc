// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/measure/size_biases.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "vdb_madf/base/detail/median.h"
#include "vdb_madf/grids/object_keys.h"

namespace vdb_madf {

namespace {

struct Point {
  double radius, bias;
};

struct Row {
  const char* number;
  bool ofBonds;  // the radius is that of the bonds, as measured
  std::vector<Point> clean, scan;
};

/// What tests/benchmark/packs prints. Of bonds it has the true radius r; r sqrt(1 + bias) is the
/// measured one.
const std::vector<Row>& rows() {
  static const std::vector<Row> all{
      {"grains", false, {{2, -1}, {3, 0}}, {{2, -1}, {3, -0.01}}},
      {"specific_surface",
       false,
       {{3, -0.18}, {4, -0.14}, {6, -0.094}, {8, -0.071}, {12, -0.047}, {20, -0.028}},
       {{3, -0.20}, {4, -0.17}, {6, -0.15}, {8, -0.13}, {12, -0.098}, {20, -0.063}}},
      {"mean_coordination",
       false,
       {{3, 0.31}, {4, 0.27}, {6, 0.22}, {8, 0.17}, {12, 0.12}, {20, 0.056}},
       {{3, 0.29}, {4, 0.32}, {6, 0.30}, {8, 0.26}, {12, 0.20}, {20, 0.124}}},
      {"bond_area",
       true,
       {{1.3, 0.60}, {1.6, 0.47}, {2.3, 0.29}, {2.9, 0.17}, {4.1, 0.075}, {6.7, 0.027}},
       {{1.8, 0.91}, {2.5, 0.59}, {3.3, 0.48}, {4.7, 0.40}, {7.4, 0.27}}},
  };
  return all;
}

/// Linear between points; beyond the last it goes with 1 / radius.
double biasAt(const std::vector<Point>& points, double radius) {
  if (radius <= points.front().radius) return points.front().bias;
  const auto after = std::find_if(points.begin(), points.end(),
                                  [&](const Point& point) { return point.radius >= radius; });
  if (after == points.end()) return points.back().bias * points.back().radius / radius;
  const Point& a = *(after - 1);
  return a.bias + (after->bias - a.bias) * (radius - a.radius) / (after->radius - a.radius);
}

double enoughOf(const std::vector<Point>& points) {
  constexpr double kStep = 0.1;
  double radius = points.front().radius;
  while (std::abs(biasAt(points, radius)) > kTrusted) radius += kStep;
  return radius;
}

/// Of a slice nothing is said: its grains have no volume.
bool isSlice(const CoordBBox& box) {
  return box.min().x() == box.max().x() || box.min().y() == box.max().y() ||
         box.min().z() == box.max().z();
}

double medianRadius(const std::vector<BondMeasures>& bonds) {
  std::vector<double> radii;
  for (const BondMeasures& bond : bonds) radii.push_back(bond.equivalentRadius);
  return detail::upperMedian(std::move(radii));
}

}  // namespace

std::vector<SizeBias> sizeBiases(const Measurements& measured) {
  std::vector<SizeBias> biases;
  if (measured.grains.empty() || isSlice(measured.sample.box)) return biases;
  const bool ofScan = measured.scan || measured.metadata[kThresholdKey];
  for (const Row& row : rows()) {
    if (row.ofBonds && measured.bonds.empty()) continue;
    const double radius = row.ofBonds ? medianRadius(measured.bonds)
                                      : diameterPercentile(measured.grains, 0.5, true) / 2;
    const std::vector<Point>& points = ofScan ? row.scan : row.clean;
    const double expected = biasAt(points, radius);
    if (std::abs(expected) > kTrusted)
      biases.push_back({row.number, expected, radius, enoughOf(points)});
  }
  return biases;
}

std::string toString(const SizeBias& bias) {
  return fmt::format(
      "{} about {:+.0f} % at a median radius of {:.1f} voxels (within {:.0f} % from "
      "{:.0f} on)",
      bias.number, 100 * bias.expected, bias.radius, 100 * kTrusted, std::ceil(bias.enough));
}

}  // namespace vdb_madf
