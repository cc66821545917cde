// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

// What leads from face to face: the minimum cut against all cuts there are, the conductivity
// against elimination, and both on layers.

#include "vdb_madf/measure/crossing.h"

#include <map>
#include <numeric>

#include "support/catch.h"
#include "support/known_bodies.h"
#include "support/refusals.h"
#include "vdb_madf/grids/grid_metadata.h"
#include "vdb_madf/measure/measure.h"

using namespace vdb_madf;
using namespace vdb_madf::test;

namespace {

Measurements measureCrossing(const Int32Grid& labels) {
  MeasureOptions options;
  options.crossings = true;
  return measure(labels, options);
}

/// Voxels of a box belong to the nearest of some points, a share of them to none; so few grains
/// that all cuts can be tried.
Int32Grid::Ptr randomGrains(Rng& rng) {
  const CoordBBox box = boxAt(Coord(rng.between(-9, 9), 3, -40),
                              Coord(rng.between(6, 14), rng.between(6, 14), rng.between(6, 14)));
  std::vector<Vec3d> points;
  for (int i = rng.between(2, 12); i > 0; --i)
    points.push_back(box.min().asVec3d() + randomPoint(rng) * box.dim().asVec3d());
  const double holes = rng.chance(0.5) ? 0 : 0.4 * rng.unit();
  auto labels = drawLabels(box, [&](const Vec3d& p) {
    if (rng.chance(holes)) return 0;
    const auto nearer = [&](const Vec3d& a, const Vec3d& b) {
      return (p - a).lengthSqr() < (p - b).lengthSqr();
    };
    return int(std::min_element(points.begin(), points.end(), nearer) - points.begin()) + 1;
  });
  setDomain(*labels, box);
  if (rng.chance(0.3)) labels->transform().preScale(Vec3d(2, 3, 2.5));
  return labels;
}

struct Sides {
  bool lower, upper;
};

Sides sidesOf(const GrainMeasures& grain, const CoordBBox& box, int axis) {
  return {grain.box.min()[axis] == box.min()[axis], grain.box.max()[axis] == box.max()[axis]};
}

std::map<int32_t, size_t> rowsOf(const Measurements& m) {
  std::map<int32_t, size_t> rows;
  for (size_t i = 0; i < m.grains.size(); ++i) rows[m.grains[i].id] = i;
  return rows;
}

/// The least area of bonds between two sets of grains, of all sets that part the faces.
std::optional<double> leastCut(const Measurements& m, int axis) {
  const auto rows = rowsOf(m);
  std::optional<double> least;
  for (uint32_t set = 0; set < 1u << m.grains.size(); ++set) {
    bool parts = true;
    for (size_t i = 0; i < m.grains.size(); ++i) {
      const Sides sides = sidesOf(m.grains[i], m.sample.box, axis);
      const bool below = set >> i & 1;
      parts = parts && !(sides.lower && !below) && !(sides.upper && below);
    }
    if (!parts) continue;
    double area = 0;
    for (const BondMeasures& bond : m.bonds)
      if ((set >> rows.at(bond.first) & 1) != (set >> rows.at(bond.second) & 1)) area += bond.area;
    if (!least || area < *least) least = area;
  }
  return least;
}

/// What a grain has between its centroid and one of its contacts, as README.md tells it.
double resistance(const Vec3d& arm, double area, double volume, double allAlongArm) {
  const double d = arm.length(), share = area * d * d / allAlongArm;
  const double section = share * volume / d, a = std::sqrt(area / M_PI),
               b = std::sqrt(section / M_PI);
  return d / section + (a < b ? std::pow(1 - a / b, 1.5) : 0) / (4 * a);
}

/// Conductances between the nodes: the grains, the lower and the upper face.
using Matrix = std::vector<std::vector<double>>;

Matrix conductances(const Measurements& m, int axis) {
  struct Leg {
    Vec3d arm;
    double area;
    size_t bond, face;  // of these the one that it is
  };
  const size_t n = m.grains.size(), none = ~size_t(0);
  const auto rows = rowsOf(m);
  std::vector<std::vector<Leg>> legs(n);
  for (size_t i = 0; i < m.bonds.size(); ++i)
    for (const int32_t id : {m.bonds[i].first, m.bonds[i].second}) {
      const size_t row = rows.at(id);
      legs[row].push_back(
          {(m.bonds[i].centroid - m.grains[row].centroid) * m.edges, m.bonds[i].area, i, none});
    }
  for (size_t row = 0; row < n; ++row)
    for (int along = 0; along < 3; ++along) {
      const Sides sides = sidesOf(m.grains[row], m.sample.box, along);
      const double area =
          m.grains[row].cutAreas[size_t(along)] / (sides.lower && sides.upper ? 2 : 1);
      for (const bool upper : {false, true}) {
        if (!(upper ? sides.upper : sides.lower)) continue;
        Vec3d arm(0);
        arm[along] = upper ? m.sample.box.max()[along] + 0.5 - m.grains[row].centroid[along]
                           : m.sample.box.min()[along] - 0.5 - m.grains[row].centroid[along];
        const size_t face = along == axis ? n + upper : none;
        legs[row].push_back({arm * m.edges, area, none, face});
      }
    }
  Matrix matrix(n + 2, std::vector<double>(n + 2));
  std::vector<double> ofBond(m.bonds.size());
  for (size_t row = 0; row < n; ++row)
    for (const Leg& leg : legs[row]) {
      double all = 0;
      for (const Leg& other : legs[row]) {
        const double reach = other.arm.dot(leg.arm) / leg.arm.length();
        all += other.area * reach * reach;
      }
      const double r = resistance(leg.arm, leg.area, m.grains[row].volume, all);
      if (leg.bond != none) ofBond[leg.bond] += r;
      if (leg.face != none) matrix[row][leg.face] = matrix[leg.face][row] = 1 / r;
    }
  for (size_t i = 0; i < m.bonds.size(); ++i) {
    const size_t a = rows.at(m.bonds[i].first), b = rows.at(m.bonds[i].second);
    matrix[a][b] = matrix[b][a] = 1 / ofBond[i];
  }
  return matrix;
}

/// Takes out one node after the other (the star-mesh transform); what is left is what lies between
/// the two faces.
double between(Matrix g) {
  const size_t n = g.size();
  for (size_t k = 0; k + 2 < n; ++k) {
    const double sum = std::accumulate(g[k].begin() + std::ptrdiff_t(k) + 1, g[k].end(), 0.0);
    if (sum == 0) continue;
    for (size_t i = k + 1; i < n; ++i)
      for (size_t j = k + 1; j < n; ++j)
        if (i != j) g[i][j] += g[i][k] * g[k][j] / sum;
  }
  return g[n - 2][n - 1];
}

}  // namespace

TEST_CASE("crossing: the minimum cut is the least of all cuts", "[crossing]") {
  Rng rng(5);
  int cuts = 0, spanned = 0;
  for (int i = 0; i < 60; ++i) {
    CAPTURE(i);
    const Measurements m = measureCrossing(*randomGrains(rng));
    for (int axis = 0; axis < 3; ++axis) {
      const Crossing& crossing = m.crossings.value()[size_t(axis)];
      const std::optional<double> least = leastCut(m, axis);
      REQUIRE(crossing.cutArea.has_value() == least.has_value());
      ++(least ? cuts : spanned);
      double area = 0;
      int64_t bonds = 0;
      for (const BondMeasures& bond : m.bonds)
        if (bond.crossing->inCut[size_t(axis)]) {
          area += bond.area;
          ++bonds;
        }
      CHECK(bonds == crossing.cutBonds);
      CHECK(area == Approx(crossing.cutArea.value_or(0)).margin(1e-9));
      if (least) CHECK(area == Approx(*least).margin(1e-4));
    }
  }
  CHECK(cuts > 40);
  CHECK(spanned > 40);
}

TEST_CASE("crossing: the conductivity is that of the network", "[crossing]") {
  Rng rng(8);
  int conduct = 0;
  for (int i = 0; i < 60; ++i) {
    CAPTURE(i);
    const Measurements m = measureCrossing(*randomGrains(rng));
    for (int axis = 0; axis < 3; ++axis) {
      const Crossing& crossing = m.crossings.value()[size_t(axis)];
      const Vec3d extent = m.sample.box.dim().asVec3d() * m.edges;
      CHECK(crossing.section == Approx(extent[(axis + 1) % 3] * extent[(axis + 2) % 3]));
      const double all = between(conductances(m, axis));
      CHECK(crossing.conductivity ==
            Approx(all * extent[axis] / crossing.section).epsilon(1e-9).margin(1e-12));
      conduct += all > 0;
      // What crosses a cut is all there is, where no current returns through it.
      if (crossing.cutArea && *crossing.cutArea > 0) {
        double current = 0;
        for (const BondMeasures& bond : m.bonds)
          if (bond.crossing->inCut[size_t(axis)]) current += bond.crossing->current[size_t(axis)];
        CHECK(current > 1 - 1e-9);
      }
    }
  }
  CHECK(conduct > 100);
}

TEST_CASE("crossing: layers conduct as their material, but for gaps", "[crossing]") {
  const CoordBBox box = boxAt(Coord(-3, 5, 0), Coord(20, 24, 40));
  auto layers = drawLabels(box, [](const Vec3d& p) { return int(p[2]) / 8 + 1; });
  setDomain(*layers, box);
  const Measurements m = measureCrossing(*layers);
  REQUIRE(m.bonds.size() == 4);
  const auto& crossings = m.crossings.value();
  for (const Crossing& crossing : crossings)
    CHECK(crossing.conductivity == Approx(1).epsilon(1e-6));
  CHECK_FALSE(crossings[0].cutArea);
  CHECK_FALSE(crossings[1].cutArea);
  CHECK(crossings[2].cutArea.value() == Approx(20 * 24));
  CHECK(crossings[2].cutBonds == 1);
  CHECK(m.bonds[0].crossing->inCut[2]);  // of four equal ones the lowest
  for (const BondMeasures& bond : m.bonds)
    CHECK(bond.crossing->current[2] == Approx(1).epsilon(1e-9));

  // Every other column of layers: half of it conducts. One layer away: nothing does.
  for (const bool isParted : {false, true}) {
    auto column = drawLabels(box, [&](const Vec3d& p) {
      const int layer = int(p[2]) / 8;
      return p[0] < 7 && !(isParted && layer == 2) ? layer + 1 : 0;
    });
    setDomain(*column, box);
    const Crossing along = measureCrossing(*column).crossings.value()[2];
    CHECK(along.conductivity == Approx(isParted ? 0 : 0.5).epsilon(1e-2).margin(1e-12));
    CHECK(along.cutArea.value() == Approx(isParted ? 0 : 10 * 24).epsilon(0.05));
  }
}

TEST_CASE("crossing: grains of nothing, and what cannot be had", "[crossing]") {
  const CoordBBox box = boxAt(Coord(0), Coord(9, 9, 9));
  auto labels = Int32Grid::create(0);
  setDomain(*labels, box);
  const Measurements empty = measureCrossing(*labels);
  for (const Crossing& crossing : empty.crossings.value()) {
    CHECK(crossing.cutArea.value() == 0);
    CHECK(crossing.conductivity == 0);
  }
  MeasureOptions options;
  options.crossings = true;
  options.boundary = Boundary::closed;
  CHECK_THROWS_WITH(measure(*labels, options), Contains("open"));
  auto noDomain = drawLabels(box, [](const Vec3d&) { return 1; });
  options.boundary = Boundary::automatic;
  CHECK_THROWS_WITH(measure(*noDomain, options), Contains("domain"));
}
