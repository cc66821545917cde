// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

// What leads from face to face: the minimum cut against all cuts there are, the conductivity
// against elimination, the tensor against relaxation, and all on layers and rods.

#include "vdb_madf/measure/crossing.h"

#include <algorithm>
#include <cmath>
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

/// Where a grain ends.
struct Leg {
  Vec3d arm;
  double area;
  std::optional<size_t> bond;  // else at a face of the box:
  int axis = 0;
  bool isUpper = false;
  double conductance = 0;
  Vec3d place{0};  // of its middle, in space
};

/// Of all voxel faces at the faces of the box, by grain, axis and end: the mean and the area.
void addFaces(const Int32Grid& labels, const Measurements& m, std::vector<std::vector<Leg>>& legs) {
  const CoordBBox& box = m.sample.box;
  for (size_t row = 0; row < m.grains.size(); ++row)
    for (int axis = 0; axis < 3; ++axis)
      for (const bool isUpper : {false, true}) {
        const int at = isUpper ? box.max()[axis] : box.min()[axis];
        Vec3d sum(0);
        int count = 0;
        for (auto voxel = labels.cbeginValueOn(); voxel; ++voxel)
          if (voxel.getCoord()[axis] == at && *voxel == m.grains[row].id) {
            sum += voxel.getCoord().asVec3d();
            ++count;
          }
        if (count == 0) continue;
        Vec3d middle = sum / count;
        middle[axis] += isUpper ? 0.5 : -0.5;
        const Vec3d place = middle * m.edges;
        legs[row].push_back({place - m.grains[row].centroid * m.edges,
                             count * m.edges[(axis + 1) % 3] * m.edges[(axis + 2) % 3],
                             {},
                             axis,
                             isUpper,
                             0,
                             place});
      }
}

/// Of each grain, with the conductances.
std::vector<std::vector<Leg>> legsOf(const Int32Grid& labels, const Measurements& m) {
  const auto rows = rowsOf(m);
  std::vector<std::vector<Leg>> legs(m.grains.size());
  for (size_t i = 0; i < m.bonds.size(); ++i)
    for (const int32_t id : {m.bonds[i].first, m.bonds[i].second}) {
      const size_t row = rows.at(id);
      legs[row].push_back(
          {(m.bonds[i].centroid - m.grains[row].centroid) * m.edges, m.bonds[i].area, i});
    }
  addFaces(labels, m, legs);
  for (size_t row = 0; row < legs.size(); ++row)
    for (Leg& leg : legs[row]) {
      double all = 0;
      for (const Leg& other : legs[row]) {
        const double reach = other.arm.dot(leg.arm) / leg.arm.length();
        all += other.area * reach * reach;
      }
      leg.conductance = 1 / resistance(leg.arm, leg.area, m.grains[row].volume, all);
    }
  return legs;
}

struct Network {
  Measurements measured;
  std::vector<std::vector<Leg>> legs;
};

Network randomNetwork(Rng& rng) {
  const auto labels = randomGrains(rng);
  const Measurements measured = measureCrossing(*labels);
  return {measured, legsOf(*labels, measured)};
}

/// Conductances between the nodes: the grains, and two more that are left to the caller.
using Matrix = std::vector<std::vector<double>>;

Matrix conductances(const Measurements& m, const std::vector<std::vector<Leg>>& legs) {
  const size_t n = m.grains.size();
  const auto rows = rowsOf(m);
  Matrix matrix(n + 2, std::vector<double>(n + 2));
  std::vector<double> ofBond(m.bonds.size());
  for (const auto& ofGrain : legs)
    for (const Leg& leg : ofGrain)
      if (leg.bond) ofBond[*leg.bond] += 1 / leg.conductance;
  for (size_t i = 0; i < m.bonds.size(); ++i) {
    const size_t a = rows.at(m.bonds[i].first), b = rows.at(m.bonds[i].second);
    matrix[a][b] = matrix[b][a] = 1 / ofBond[i];
  }
  return matrix;
}

/// With the lower and the upper face as the last nodes.
Matrix betweenFaces(const Measurements& m, const std::vector<std::vector<Leg>>& legs, int axis) {
  Matrix matrix = conductances(m, legs);
  const size_t n = m.grains.size();
  for (size_t row = 0; row < n; ++row)
    for (const Leg& leg : legs[row])
      if (!leg.bond && leg.axis == axis)
        matrix[row][n + leg.isUpper] = matrix[n + leg.isUpper][row] = leg.conductance;
  return matrix;
}

/// The potentials of the grains while all faces are at their places along an axis, by sweeps that
/// set each grain to the mean of what it touches.
std::vector<double> relaxed(const Matrix& g, const std::vector<std::vector<Leg>>& legs, int axis) {
  std::vector<double> potential(legs.size());
  for (int sweep = 0; sweep < 3000; ++sweep)
    for (size_t i = 0; i < legs.size(); ++i) {
      double weights = 0, sum = 0;
      for (size_t j = 0; j < legs.size(); ++j) {
        weights += g[i][j];
        sum += g[i][j] * potential[j];
      }
      for (const Leg& leg : legs[i])
        if (!leg.bond) {
          weights += leg.conductance;
          sum += leg.conductance * leg.place[axis];
        }
      if (weights > 0) potential[i] = sum / weights;
    }
  return potential;
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
      const Crossing& crossing = m.crossings.value().along[size_t(axis)];
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

TEST_CASE("crossing: a bond of area 0 conducts nothing", "[crossing]") {
  const CoordBBox box(Coord(0), Coord(2, 1, 1));
  const auto labels = drawLabels(box, [](const Vec3d& p) {  // opposite faces cancel one another
    const int label = int(std::min(1.0, p.x()) + p.y() + p.z()) % 2 + 1;
    return p.x() < 2 || label == 1 ? label : 0;
  });
  setDomain(*labels, box);
  const Measurements m = measureCrossing(*labels);
  REQUIRE(m.bonds.size() == 1);
  REQUIRE(m.bonds[0].area == 0);
  for (size_t axis = 0; axis < 3; ++axis) {
    CHECK(m.bonds[0].crossing->current[axis] == 0);
    CHECK(m.crossings->along[axis].conductivity >= 0);
  }
  CHECK(m.crossings->along[0].conductivity > 0);
  for (const double component : m.crossings->conductivity.components)
    CHECK(std::isfinite(component));
}

TEST_CASE("crossing: nothing flows through dead ends, and no more than all", "[crossing]") {
  constexpr int kGrains = 150;
  Rng rng(3);
  std::vector<int> from{0};  // a rod of unequal pieces along x, with arms of two grains each
  for (int i = 0; i < kGrains; ++i) from.push_back(from.back() + rng.between(3, 9));
  const CoordBBox box(Coord(0, 0, 0), Coord(from.back() - 1, 3, 12));
  const auto labels = drawLabels(box, [&](const Vec3d& p) {
    const int i = int(std::upper_bound(from.begin(), from.end(), int(p.x())) - from.begin()) - 1;
    if (p.z() < 4) return i + 1;
    if (p.z() > 9 || int(p.x()) == from[size_t(i)] || i == kGrains - 1) return 0;
    return i + 1 + kGrains * (p.z() < 7 ? 1 : 2);
  });
  setDomain(*labels, box);
  const Measurements m = measureCrossing(*labels);
  REQUIRE(m.bonds.size() == 3 * (kGrains - 1));
  for (const BondMeasures& bond : m.bonds)
    if (bond.second > kGrains) {
      CHECK(bond.crossing->current[0] == 0);
    } else {
      CHECK(bond.crossing->current[0] <= 1);
      CHECK(bond.crossing->current[0] == Approx(1).epsilon(1e-6));
    }
}

TEST_CASE("crossing: a current is the same in all links of a long chain of unequal ones",
          "[crossing]") {
  constexpr int kGrains = 2000, kEdge = 10;
  Rng rng(5);
  Measurements m;
  m.edges = Vec3d(1);
  m.sample.box = CoordBBox(Coord(0), Coord(kGrains * kEdge - 1, kEdge - 1, kEdge - 1));
  for (int i = 0; i < kGrains; ++i) {
    GrainMeasures grain;
    grain.id = i + 1;
    grain.volume = kEdge * kEdge * kEdge;
    grain.centroid = Vec3d(kEdge * (i + 0.5) - 0.5, 4.5, 4.5);
    m.grains.push_back(grain);
  }
  for (int i = 0; i + 1 < kGrains; ++i) {
    BondMeasures bond;
    bond.first = i + 1;
    bond.second = i + 2;
    bond.area = kEdge * kEdge * std::pow(10, -8 * rng.unit());
    bond.centroid = Vec3d(kEdge * (i + 1) - 0.5, 4.5, 4.5);
    m.bonds.push_back(bond);
  }
  for (const bool isUpper : {false, true}) {
    GrainCut cut;
    cut.axis = 0;
    cut.isUpper = isUpper;
    cut.area = kEdge * kEdge;
    cut.centroid = Vec3d(isUpper ? kGrains * kEdge - 0.5 : -0.5, 4.5, 4.5);
    (isUpper ? m.grains.back() : m.grains.front()).cuts.push_back(cut);
  }
  measureCrossings(m);
  CHECK(m.crossings->along[0].conductivity > 0);
  double least = 1;
  for (const BondMeasures& bond : m.bonds) least = std::min(least, bond.crossing->current[0]);
  CHECK(least == Approx(1).epsilon(1e-6));
}

TEST_CASE("crossing: the conductivity is that of the network", "[crossing]") {
  Rng rng(8);
  int conduct = 0;
  for (int i = 0; i < 60; ++i) {
    CAPTURE(i);
    const auto [m, legs] = randomNetwork(rng);
    for (int axis = 0; axis < 3; ++axis) {
      const Crossing& crossing = m.crossings.value().along[size_t(axis)];
      const Vec3d extent = m.sample.box.dim().asVec3d() * m.edges;
      CHECK(crossing.section == Approx(extent[(axis + 1) % 3] * extent[(axis + 2) % 3]));
      const double all = between(betweenFaces(m, legs, axis));
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

TEST_CASE("crossing: the tensor is that of the network, and bounds the conductivity",
          "[crossing]") {
  Rng rng(13);
  int conduct = 0;
  for (int i = 0; i < 60; ++i) {
    CAPTURE(i);
    const auto [m, legs] = randomNetwork(rng);
    const Matrix g = conductances(m, legs);
    const SymmetricTensor& tensor = m.crossings.value().conductivity;
    const double volume = (m.sample.box.dim().asVec3d() * m.edges).product();
    for (int gradient = 0; gradient < 3; ++gradient) {
      const std::vector<double> potential = relaxed(g, legs, gradient);
      Vec3d flux(0);
      for (size_t row = 0; row < legs.size(); ++row)
        for (const Leg& leg : legs[row])
          if (!leg.bond)
            flux += leg.place * leg.conductance * (leg.place[gradient] - potential[row]) / volume;
      for (int axis = 0; axis < 3; ++axis) {
        CAPTURE(gradient, axis);
        CHECK(tensor.at(gradient, axis) == Approx(flux[axis]).epsilon(1e-6).margin(1e-9));
      }
      const double along = m.crossings->along[size_t(gradient)].conductivity;
      CHECK(tensor.at(gradient, gradient) > along * (1 - 1e-9));
      conduct += along > 0;
    }
    CHECK(tensor.principal.values[2] > -1e-12);
  }
  CHECK(conduct > 100);
}

TEST_CASE("crossing: rods that lean conduct along themselves", "[crossing]") {
  // In layers across y, from the lower to the upper end of a high box: along (3, 0, 4) / 5.
  const CoordBBox box = boxAt(Coord(-20, 3, 7), Coord(300, 20, 160));
  auto rods = drawLabels(box, [](const Vec3d& p) {
    const double across = 4 * p[0] - 3 * p[2] + 10000;
    return int(p[1]) % 4 < 2 && int(across) % 100 < 50 ? int(across) / 100 * 100 + int(p[1]) / 4
                                                       : 0;
  });
  setDomain(*rods, box);
  const Measurements m = measureCrossing(*rods);
  REQUIRE(m.bonds.empty());
  const auto& t = m.crossings.value().conductivity;
  const double solid = m.sample.objectFraction;
  CHECK(t.components[0] == Approx(0.36 * solid).epsilon(0.02));
  CHECK(t.components[2] == Approx(0.64 * solid).epsilon(0.02));
  CHECK(t.components[4] == Approx(0.48 * solid).epsilon(0.02));
  CHECK(t.principal.values[0] == Approx(solid).epsilon(0.02));
  CHECK(std::abs(t.principal.axes[0].dot(Vec3d(0.6, 0, 0.8))) > 0.9999);
  CHECK(t.principal.values[1] < 0.02 * solid);
}

TEST_CASE("crossing: layers conduct as their material, but for gaps", "[crossing]") {
  const CoordBBox box = boxAt(Coord(-3, 5, 0), Coord(20, 24, 40));
  auto layers = drawLabels(box, [](const Vec3d& p) { return int(p[2]) / 8 + 1; });
  setDomain(*layers, box);
  const Measurements m = measureCrossing(*layers);
  REQUIRE(m.bonds.size() == 4);
  const auto& crossings = m.crossings.value().along;
  for (const Crossing& crossing : crossings)
    CHECK(crossing.conductivity == Approx(1).epsilon(1e-6));
  for (size_t i = 0; i < 6; ++i)
    CHECK(m.crossings->conductivity.components[i] == Approx(i < 3).epsilon(1e-6).margin(1e-9));
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
    const Crossing along = measureCrossing(*column).crossings.value().along[2];
    CHECK(along.conductivity == Approx(isParted ? 0 : 0.5).epsilon(1e-2).margin(1e-12));
    CHECK(along.cutArea.value() == Approx(isParted ? 0 : 10 * 24).epsilon(0.05));
  }
}

TEST_CASE("crossing: grains of nothing, and what cannot be had", "[crossing]") {
  const CoordBBox box = boxAt(Coord(0), Coord(9, 9, 9));
  auto labels = Int32Grid::create(0);
  setDomain(*labels, box);
  const Measurements empty = measureCrossing(*labels);
  for (const Crossing& crossing : empty.crossings.value().along) {
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
