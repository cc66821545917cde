// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/measure/crossing.h"

#include <Eigen/IterativeLinearSolvers>
#include <Eigen/SparseCore>
#include <algorithm>
#include <cmath>
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

/// The lower (0) and the upper face (1) normal to an axis.
struct Face {
  int axis, end;
};

/// A bond as a conductor between two grains.
struct Conductor {
  std::array<uint32_t, 2> grains;  ///< rows
  double conductance = 0;
};

class GrainConductors {
 public:
  explicit GrainConductors(const Measurements& measured) : measured_(measured) {
    contacts_.resize(measured.grains.size());
    for (size_t i = 0; i < measured.bonds.size(); ++i) addBond(measured.bonds[i]);
    for (size_t row = 0; row < measured.grains.size(); ++row) addFaces(uint32_t(row));
    for (size_t row = 0; row < measured.grains.size(); ++row) addResistances(uint32_t(row));
    for (Conductor& bond : bonds_) bond.conductance = 1 / bond.conductance;
  }

  const std::vector<Conductor>& bonds() const { return bonds_; }
  /// From a grain to a face of the box; 0 if it does not touch it.
  double toFace(uint32_t row, Face face) const {
    double conductance = 0;
    for (const Wall& wall : walls_[row])
      if (wall.face.axis == face.axis && wall.face.end == face.end) conductance = wall.conductance;
    return conductance;
  }
  double extent(int axis) const { return measured_.sample.box.dim()[axis] * measured_.edges[axis]; }

 private:
  struct Wall {
    Face face;
    double conductance;
  };
  /// Of a grain: to a bond, or to a face.
  struct End {
    detail::Contact contact;
    int64_t bond;
    Face face;
  };

  Vec3d place(const Vec3d& index) const { return index * measured_.edges; }
  void addBond(const BondMeasures& bond) {
    const auto& grains = measured_.grains;
    const Conductor conductor{
        {uint32_t(rowOf(grains, bond.first)), uint32_t(rowOf(grains, bond.second))}, 0};
    for (const uint32_t row : conductor.grains)
      contacts_[row].push_back(
          {{place(bond.centroid) - place(measured_.grains[row].centroid), bond.area},
           int64_t(bonds_.size()),
           {}});
    bonds_.push_back(conductor);
  }
  /// A grain that reaches from face to face has half of what is cut across this axis at each.
  void addFaces(uint32_t row) {
    const GrainMeasures& grain = measured_.grains[row];
    const CoordBBox& box = measured_.sample.box;
    for (int axis = 0; axis < 3; ++axis) {
      const bool touches[] = {grain.box.min()[axis] <= box.min()[axis],
                              grain.box.max()[axis] >= box.max()[axis]};
      for (const int end : {0, 1}) {
        if (!touches[end]) continue;
        Vec3d middle = grain.centroid;
        middle[axis] = end == 0 ? box.min()[axis] - 0.5 : box.max()[axis] + 0.5;
        const double area = grain.cutAreas[size_t(axis)] / (touches[0] && touches[1] ? 2 : 1);
        contacts_[row].push_back({{place(middle) - place(grain.centroid), area}, -1, {axis, end}});
      }
    }
  }
  void addResistances(uint32_t row) {
    std::vector<detail::Contact> contacts;
    for (const End& end : contacts_[row]) contacts.push_back(end.contact);
    const std::vector<double> resistances =
        detail::contactResistances(measured_.grains[row].volume, contacts);
    walls_.emplace_back();
    for (size_t i = 0; i < contacts.size(); ++i) {
      const End& end = contacts_[row][i];
      if (end.bond >= 0)
        bonds_[size_t(end.bond)].conductance += resistances[i];
      else
        walls_.back().push_back({end.face, 1 / resistances[i]});
    }
  }

  const Measurements& measured_;
  std::vector<std::vector<End>> contacts_;  // of each grain
  std::vector<Conductor> bonds_;
  std::vector<std::vector<Wall>> walls_;  // of each grain
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
    const double up = network.toFace(row, {axis, 1});
    inflow[row] = up;
    diagonal[row] += up + network.toFace(row, {axis, 0});
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
  for (uint32_t row = 0; row < grains; ++row)
    all += network.toFace(row, {axis, 0}) * potential[row];
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
    const bool isLower = grain.min()[axis] <= box.min()[axis];
    const bool isUpper = grain.max()[axis] >= box.max()[axis];
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
