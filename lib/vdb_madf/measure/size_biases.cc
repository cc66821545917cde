// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/measure/size_biases.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "vdb_madf/base/detail/median.h"
#include "vdb_madf/base/detail/text.h"
#include "vdb_madf/grids/object_keys.h"

namespace vdb_madf {

namespace {

struct Point {
  double radius, bias;
};

/// Point spreads of the scans in the table, as ScanBlur::sigma: none, and those of
/// `--scan-noise 0.7:0.05` and `1:0.05`.
constexpr std::array<double, 3> kBlurs{0.29, 0.76, 1.04};
constexpr double kUsualBlur = kBlurs[1];

struct Row {
  const char* number;
  bool ofBonds;  // the radius is that of the bonds, as measured in the labels
  bool ofScan;   // is there with the necks of a scan alone
  std::array<std::vector<Point>, kBlurs.size()> points;
};

/// What tests/benchmark/packs prints. Of bonds it has the true radius r; r sqrt(1 + bias) is the
/// measured one.
const std::vector<Row>& rows() {
  static const std::vector<Row> all{
      {"grains", false, false, {{{{2, -1}, {3, 0}}, {{2, -1}, {3, -0.01}}, {{3, -1}, {4, 0}}}}},
      {"specific_surface",
       false,
       false,
       {{{{3, -0.18}, {4, -0.14}, {6, -0.094}, {8, -0.071}, {12, -0.047}, {20, -0.028}},
         {{3, -0.20}, {4, -0.17}, {6, -0.15}, {8, -0.13}, {12, -0.098}, {20, -0.063}},
         {{4, -0.157}, {6, -0.139}, {8, -0.135}, {12, -0.112}, {20, -0.075}}}}},
      {"mean_coordination",
       false,
       false,
       {{{{3, 0.31}, {4, 0.27}, {6, 0.22}, {8, 0.17}, {12, 0.12}, {20, 0.056}},
         {{3, 0.29}, {4, 0.32}, {6, 0.30}, {8, 0.26}, {12, 0.20}, {20, 0.124}},
         {{4, 0.33}, {6, 0.32}, {8, 0.30}, {12, 0.25}, {20, 0.157}}}}},
      {"bond_area",
       true,
       false,
       {{{{1.3, 0.60}, {1.6, 0.47}, {2.3, 0.29}, {2.9, 0.17}, {4.1, 0.075}, {6.7, 0.027}},
         {{1.8, 0.91}, {2.5, 0.59}, {3.3, 0.48}, {4.7, 0.40}, {7.4, 0.27}},
         {{1.95, 1.25}, {2.76, 0.90}, {3.5, 0.69}, {5.0, 0.58}, {7.9, 0.43}}}}},
      {"neck_area",
       true,
       true,
       {{{{2.5, 0}},
         {{2.5, 0.037}, {3.3, 0.086}, {4.7, 0.019}, {7.4, 0.031}},
         {{2.8, -0.53}, {3.5, -0.074}, {5.0, 0.031}, {7.9, 0.034}}}}},
      {"contact_coordination",
       false,
       true,
       {{{{6, 0}},
         {{6, -0.032}, {8, 0}, {12, -0.002}, {20, 0.009}},
         {{6, -0.89}, {8, -0.054}, {12, -0.008}, {20, -0.003}}}}},
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

/// Linear between blurs; that of the last for all that are wider.
double biasAt(const Row& row, double blur, double radius) {
  blur = std::clamp(blur, kBlurs.front(), kBlurs.back());
  const size_t next = blur > kBlurs[1] ? 2 : 1;
  const double share = (blur - kBlurs[next - 1]) / (kBlurs[next] - kBlurs[next - 1]);
  return (1 - share) * biasAt(row.points[next - 1], radius) +
         share * biasAt(row.points[next], radius);
}

/// The radius from which on a bias is small enough, if it is not at this one.
double enoughOf(const Row& row, double blur, double radius) {
  constexpr double kStep = 0.1;
  while (std::abs(biasAt(row, blur, radius)) > kTrusted) radius += kStep;
  return radius;
}

/// The point spread of what was thresholded: smoothing adds to that of the scan by squares.
double blurOf(const Measurements& measured) {
  if (!measured.scan && !measured.metadata[kThresholdKey]) return kBlurs.front();
  const double scan = measured.scan ? measured.scan->sigma : kUsualBlur;
  const std::string word = "smooth ";  // of madf_object
  const auto steps = measured.metadata.getMetadata<openvdb::StringMetadata>(kObjectKey);
  const size_t at = steps ? steps->value().find(word) : std::string::npos;
  if (at == std::string::npos) return scan;
  return std::hypot(scan, detail::leadingReal(steps->value().substr(at + word.size())).value);
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
  const double ofObject = blurOf(measured);
  const openvdb::Vec3d& edges = measured.edges;
  const double edge = std::cbrt(edges[0] * edges[1] * edges[2]);  // of a cube as large as a voxel
  for (const Row& row : rows()) {
    if ((row.ofBonds && measured.bonds.empty()) || (row.ofScan && !measured.scan)) continue;
    const double radius = (row.ofBonds ? medianRadius(measured.bonds)
                                       : diameterPercentile(measured.grains, 0.5, true) / 2) /
                          edge;
    const double blur = row.ofScan ? measured.scan->sigma : ofObject;
    const double expected = biasAt(row, blur, radius);
    if (std::abs(expected) > kTrusted)
      biases.push_back({row.number, expected, radius, enoughOf(row, blur, radius)});
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
