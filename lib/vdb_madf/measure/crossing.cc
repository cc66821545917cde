// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/measure/crossing.h"

#include <Eigen/IterativeLinearSolvers>
#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "vdb_madf/measure/detail/bond_resistance.h"
#include "vdb_madf/measure/detail/minimum_cut.h"
#include "vdb_madf/measure/detail/principal_axes.h"
#include "vdb_madf/measure/measure.h"

namespace vdb_madf {

namespace {

using openvdb::Vec3d;

constexpr double kAreaUnits = 1 << 20;  // of a cut, in a voxel face
constexpr double kTolerance = 1e-12;    // of the potentials
constexpr double kLeastCurrent = 1e-7;  // of all: less is what the solver leaves over

/// A bond as a conductor between two grains.
struct Conductor {
  std::array<uint32_t, 2> grains;  ///< rows
  double conductance;
};

/// From a grain to a face of the box that cuts it.
struct Outlet {
  uint32_t grain;  ///< row
  int axis;        ///< normal to the face
  bool isUpper;
  Vec3d place;  ///< its middle, in space
  double conductance;
};

class GrainConductors {
 public:
  explicit GrainConductors(const Measurements& measured) : measured_(measured) {
    const auto& grains = measured.grains;
    std::vector<std::vector<End>> ends(grains.size());
    for (const BondMeasures& bond : measured.bonds) {
      bonds_.push_back(
          {{uint32_t(rowOf(grains, bond.first)), uint32_t(rowOf(grains, bond.second))}, 0});
      for (const uint32_t row : bonds_.back().grains)
        ends[row].push_back({contactAt(bond.centroid, bond.area, row), bonds_.size() - 1});
    }
    for (uint32_t row = 0; row < grains.size(); ++row)
      for (const GrainCut& cut : grains[row].cuts) {
        ends[row].push_back({contactAt(cut.centroid, cut.area, row), {}});
        outlets_.push_back({row, cut.axis, cut.isUpper, cut.centroid * measured.edges, 0});
      }
    setConductances(ends);
  }

  const std::vector<Conductor>& bonds() const { return bonds_; }
  const std::vector<Outlet>& outlets() const { return outlets_; }
  double extent(int axis) const { return measured_.sample.box.dim()[axis] * measured_.edges[axis]; }

 private:
  /// Where a grain ends: at a bond, or at an outlet.
  struct End {
    detail::Contact contact;
    std::optional<size_t> bond;
  };

  detail::Contact contactAt(const Vec3d& index, double area, size_t row) const {
    return {(index - measured_.grains[row].centroid) * measured_.edges, area};
  }
  void setConductances(const std::vector<std::vector<End>>& ends) {
    std::vector<double> resistances(bonds_.size());
    auto outlet = outlets_.begin();
    for (size_t row = 0; row < ends.size(); ++row) {
      std::vector<detail::Contact> contacts;
      for (const End& end : ends[row]) contacts.push_back(end.contact);
      const auto found = detail::contactResistances(measured_.grains[row].volume, contacts);
      for (size_t i = 0; i < found.size(); ++i) {
        if (const auto bond = ends[row][i].bond)
          resistances[*bond] += found[i];
        else
          outlet++->conductance = 1 / found[i];
      }
    }
    for (size_t i = 0; i < bonds_.size(); ++i) bonds_[i].conductance = 1 / resistances[i];
  }

  const Measurements& measured_;
  std::vector<Conductor> bonds_;
  std::vector<Outlet> outlets_;  // by grain
};

/// The network with some of its outlets held at potentials.
class HeldNetwork {
 public:
  HeldNetwork(const GrainConductors& network, size_t grains, std::vector<Outlet> held)
      : held_(std::move(held)), matrix_(Eigen::Index(grains), Eigen::Index(grains)) {
    std::vector<Eigen::Triplet<double>> terms;
    std::vector<double> diagonal(grains);
    for (const Conductor& bond : network.bonds()) {
      const auto [a, b] = bond.grains;
      terms.emplace_back(a, b, -bond.conductance);
      terms.emplace_back(b, a, -bond.conductance);
      diagonal[a] += bond.conductance;
      diagonal[b] += bond.conductance;
    }
    for (const Outlet& outlet : held_) diagonal[outlet.grain] += outlet.conductance;
    for (uint32_t row = 0; row < grains; ++row)
      terms.emplace_back(row, row, diagonal[row] > 0 ? diagonal[row] : 1);
    matrix_.setFromTriplets(terms.begin(), terms.end());
    solver_.setTolerance(kTolerance);
    solver_.compute(matrix_);
  }
  HeldNetwork(const HeldNetwork&) = delete;  // the solver refers to the matrix
  HeldNetwork& operator=(const HeldNetwork&) = delete;

  /// Of the grains, the held outlets being at `at`(outlet). Grains that hang on none are at 0.
  /// Long chains of unequal bonds are eliminated: conjugate gradients do not come to their end.
  template <typename At>
  Eigen::VectorXd potentials(const At& at) const {
    Eigen::VectorXd inflow = Eigen::VectorXd::Zero(matrix_.rows());
    for (const Outlet& outlet : held_) inflow[outlet.grain] += outlet.conductance * at(outlet);
    const Eigen::VectorXd found = solver_.solve(inflow);
    if (solver_.info() == Eigen::Success) return found;
    return Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>>(matrix_).solve(inflow);
  }
  const std::vector<Outlet>& held() const { return held_; }

 private:
  std::vector<Outlet> held_;
  Eigen::SparseMatrix<double> matrix_;
  Eigen::ConjugateGradient<Eigen::SparseMatrix<double>, Eigen::Lower | Eigen::Upper> solver_;
};

void conduct(const GrainConductors& network, int axis, Measurements& measured, Crossing& crossing) {
  std::vector<Outlet> ofAxis;
  for (const Outlet& outlet : network.outlets())
    if (outlet.axis == axis) ofAxis.push_back(outlet);
  const HeldNetwork held(network, measured.grains.size(), std::move(ofAxis));
  const Eigen::VectorXd potential =
      held.potentials([](const Outlet& outlet) { return double(outlet.isUpper); });
  double all = 0;
  for (const Outlet& outlet : held.held())
    if (!outlet.isUpper) all += outlet.conductance * potential[outlet.grain];
  crossing.conductivity = all * network.extent(axis) / crossing.section;
  if (!(all > 0)) return;
  for (size_t i = 0; i < measured.bonds.size(); ++i) {
    const auto& [ends, conductance] = network.bonds()[i];
    const double share = std::abs(potential[ends[1]] - potential[ends[0]]) * conductance / all;
    measured.bonds[i].crossing->current[size_t(axis)] =
        share < kLeastCurrent ? 0 : std::min(share, 1.0);
  }
}

/// The moments of what flows through the faces make the mean flux.
SymmetricTensor conductivityTensor(const GrainConductors& network, const Measurements& measured) {
  constexpr int kAxes[6][2] = {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {0, 2}, {1, 2}};
  const CoordBBox& box = measured.sample.box;
  const Vec3d middle = 0.5 * (box.min() + box.max()).asVec3d() * measured.edges;
  const HeldNetwork held(network, measured.grains.size(), network.outlets());
  std::array<Eigen::VectorXd, 3> potentials;
  for (int axis = 0; axis < 3; ++axis)
    potentials[size_t(axis)] =
        held.potentials([&](const Outlet& outlet) { return (outlet.place - middle)[axis]; });
  const double volume = network.extent(0) * network.extent(1) * network.extent(2);
  SymmetricTensor tensor;
  for (size_t i = 0; i < 6; ++i) {
    const auto [a, b] = kAxes[i];
    double moment = 0;
    for (const Outlet& outlet : held.held()) {
      const Vec3d place = outlet.place - middle;
      moment += outlet.conductance * place[a] * (place[b] - potentials[size_t(b)][outlet.grain]);
    }
    tensor.components[i] = moment / volume;
  }
  tensor.principal = detail::principalAxes(tensor.components);
  return tensor;
}

/// Does a grain end at the lower or the upper face of the box, normal to an axis?
bool isCut(const GrainMeasures& grain, int axis, bool isUpper) {
  return std::any_of(grain.cuts.begin(), grain.cuts.end(), [&](const GrainCut& cut) {
    return cut.axis == axis && cut.isUpper == isUpper;
  });
}

void cut(const GrainConductors& network, int axis, Measurements& measured, Crossing& crossing) {
  std::vector<uint32_t> lower, upper;
  for (uint32_t row = 0; row < measured.grains.size(); ++row) {
    const GrainMeasures& grain = measured.grains[row];
    const bool isLower = isCut(grain, axis, false), isUpper = isCut(grain, axis, true);
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
    Crossing& crossing = measured.crossings->along[size_t(axis)];
    crossing.section = network.extent((axis + 1) % 3) * network.extent((axis + 2) % 3);
    cut(network, axis, measured, crossing);
    if (!measured.grains.empty()) conduct(network, axis, measured, crossing);
  }
  if (!measured.grains.empty())
    measured.crossings->conductivity = conductivityTensor(network, measured);
  measured.extra.crossings = true;
}

}  // namespace vdb_madf
