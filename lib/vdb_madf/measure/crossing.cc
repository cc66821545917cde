// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/measure/crossing.h"

#include <Eigen/IterativeLinearSolvers>
#include <Eigen/SparseCore>
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <vector>

#include "vdb_madf/measure/detail/bond_resistance.h"
#include "vdb_madf/measure/detail/minimum_cut.h"
#include "vdb_madf/measure/measure.h"

namespace vdb_madf {

namespace {

using openvdb::Vec3d;

constexpr double kAreaUnits = 1 << 20;  // of a cut, in a voxel face
constexpr double kTolerance = 1e-12;    // of the potentials
constexpr double kLeastCurrent = 1e-9;  // of all: what is less is no more than rounding

/// Does a grain touch the lower (0) or the upper face (1) of a box, normal to an axis?
bool touches(const CoordBBox& grain, const CoordBBox& box, int axis, int end) {
  return end == 0 ? grain.min()[axis] <= box.min()[axis] : grain.max()[axis] >= box.max()[axis];
}

/// A bond as a conductor between two grains.
struct Conductor {
  std::array<uint32_t, 2> grains;  ///< rows
  double conductance;
};

class GrainConductors {
 public:
  explicit GrainConductors(const Measurements& measured)
      : measured_(measured), ends_(measured.grains.size()), toFace_(measured.grains.size()) {
    for (size_t i = 0; i < measured.bonds.size(); ++i) addBond(i);
    std::vector<double> resistances(measured.bonds.size());
    for (size_t row = 0; row < ends_.size(); ++row) {
      addFaces(row);
      addResistances(row, resistances);
    }
    for (size_t i = 0; i < bonds_.size(); ++i) bonds_[i].conductance = 1 / resistances[i];
  }

  const std::vector<Conductor>& bonds() const { return bonds_; }
  /// From a grain to the lower (0) or the upper face (1); 0 if it does not touch it.
  double toFace(size_t row, int axis, int end) const {
    return toFace_[row][size_t(axis)][size_t(end)];
  }
  double extent(int axis) const { return measured_.sample.box.dim()[axis] * measured_.edges[axis]; }

 private:
  /// Where a grain ends: at a bond, or at a face.
  struct End {
    detail::Contact contact;
    std::optional<size_t> bond;
    int axis = 0, face = 0;  ///< if it is none
  };

  detail::Contact contactAt(const Vec3d& index, double area, size_t row) const {
    return {index * measured_.edges - measured_.grains[row].centroid * measured_.edges, area};
  }
  void addBond(size_t i) {
    const BondMeasures& bond = measured_.bonds[i];
    const auto& grains = measured_.grains;
    bonds_.push_back(
        {{uint32_t(rowOf(grains, bond.first)), uint32_t(rowOf(grains, bond.second))}, 0});
    for (const uint32_t row : bonds_.back().grains)
      ends_[row].push_back({contactAt(bond.centroid, bond.area, row), i});
  }
  /// A grain that reaches from face to face has half of what is cut across this axis at each.
  void addFaces(size_t row) {
    const GrainMeasures& grain = measured_.grains[row];
    const CoordBBox& box = measured_.sample.box;
    for (int axis = 0; axis < 3; ++axis) {
      const bool both = touches(grain.box, box, axis, 0) && touches(grain.box, box, axis, 1);
      const double area = grain.cutAreas[size_t(axis)] / (both ? 2 : 1);
      for (const int face : {0, 1}) {
        if (!touches(grain.box, box, axis, face)) continue;
        Vec3d middle = grain.centroid;
        middle[axis] = face == 0 ? box.min()[axis] - 0.5 : box.max()[axis] + 0.5;
        ends_[row].push_back({contactAt(middle, area, row), {}, axis, face});
      }
    }
  }
  /// \p resistances of the bonds get what this grain has.
  void addResistances(size_t row, std::vector<double>& resistances) {
    std::vector<detail::Contact> contacts;
    for (const End& end : ends_[row]) contacts.push_back(end.contact);
    const auto found = detail::contactResistances(measured_.grains[row].volume, contacts);
    for (size_t i = 0; i < found.size(); ++i) {
      const End& end = ends_[row][i];
      if (end.bond)
        resistances[*end.bond] += found[i];
      else
        toFace_[row][size_t(end.axis)][size_t(end.face)] = 1 / found[i];
    }
  }

  const Measurements& measured_;
  std::vector<std::vector<End>> ends_;  // of each grain
  std::vector<Conductor> bonds_;
  std::vector<std::array<std::array<double, 2>, 3>> toFace_;  // of each grain
};

/// The potentials of the grains, the lower face being at 0 and the upper one at 1. Grains that hang
/// on neither are at 0.
Eigen::VectorXd potentials(const GrainConductors& network, size_t grains, int axis) {
  std::vector<Eigen::Triplet<double>> terms;
  Eigen::VectorXd inflow = Eigen::VectorXd::Zero(Eigen::Index(grains));
  Eigen::VectorXd diagonal = inflow;
  for (const Conductor& bond : network.bonds()) {
    const auto [a, b] = bond.grains;
    terms.emplace_back(a, b, -bond.conductance);
    terms.emplace_back(b, a, -bond.conductance);
    diagonal[a] += bond.conductance;
    diagonal[b] += bond.conductance;
  }
  for (uint32_t row = 0; row < grains; ++row) {
    const double up = network.toFace(row, axis, 1);
    inflow[row] = up;
    diagonal[row] += up + network.toFace(row, axis, 0);
    terms.emplace_back(row, row, diagonal[row] > 0 ? diagonal[row] : 1);
  }
  Eigen::SparseMatrix<double> matrix(inflow.size(), inflow.size());
  matrix.setFromTriplets(terms.begin(), terms.end());
  Eigen::ConjugateGradient<Eigen::SparseMatrix<double>, Eigen::Lower | Eigen::Upper> solver;
  solver.setTolerance(kTolerance);
  return solver.compute(matrix).solve(inflow);
}

void conduct(const GrainConductors& network, int axis, Measurements& measured, Crossing& crossing) {
  const size_t grains = measured.grains.size();
  const Eigen::VectorXd potential = potentials(network, grains, axis);
  double all = 0;
  for (uint32_t row = 0; row < grains; ++row) all += network.toFace(row, axis, 0) * potential[row];
  crossing.conductivity = all * network.extent(axis) / crossing.section;
  if (!(all > 0)) return;
  for (size_t i = 0; i < measured.bonds.size(); ++i) {
    const auto& [ends, conductance] = network.bonds()[i];
    const double share = std::abs(potential[ends[1]] - potential[ends[0]]) * conductance / all;
    measured.bonds[i].crossing->current[size_t(axis)] = share < kLeastCurrent ? 0 : share;
  }
}

void cut(const GrainConductors& network, int axis, Measurements& measured, Crossing& crossing) {
  std::vector<uint32_t> lower, upper;
  const CoordBBox& box = measured.sample.box;
  for (uint32_t row = 0; row < measured.grains.size(); ++row) {
    const CoordBBox& grain = measured.grains[row].box;
    const bool isLower = touches(grain, box, axis, 0), isUpper = touches(grain, box, axis, 1);
    if (isLower && isUpper) return;
    if (isLower) lower.push_back(row);
    if (isUpper) upper.push_back(row);
  }
  std::vector<detail::CutEdge> edges;
  for (size_t i = 0; i < measured.bonds.size(); ++i)
    edges.push_back({network.bonds()[i].grains,
                     std::max<int64_t>(1, std::llround(kAreaUnits * measured.bonds[i].area))});
  const std::vector<bool> below = minimumCut(measured.grains.size(), edges, lower, upper);
  crossing.cutArea = 0;
  for (size_t i = 0; i < edges.size(); ++i) {
    if (below[edges[i].nodes[0]] == below[edges[i].nodes[1]]) continue;
    *crossing.cutArea += measured.bonds[i].area;
    ++crossing.cutBonds;
    measured.bonds[i].crossing->inCut[size_t(axis)] = true;
  }
}

}  // namespace

void measureCrossings(Measurements& measured) {
  for (BondMeasures& bond : measured.bonds) bond.crossing.emplace();
  const GrainConductors network(measured);
  measured.crossings.emplace();
  for (int axis = 0; axis < 3; ++axis) {
    Crossing& crossing = (*measured.crossings)[size_t(axis)];
    crossing.section = network.extent((axis + 1) % 3) * network.extent((axis + 2) % 3);
    cut(network, axis, measured, crossing);
    if (!measured.grains.empty()) conduct(network, axis, measured, crossing);
  }
  measured.extra.crossings = true;
}

}  // namespace vdb_madf
