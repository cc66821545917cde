// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/samples/detail/power_cells.h"

#include "vdb_madf/samples/detail/least_cells.h"

namespace vdb_madf::detail {

namespace {

class PowerSites {
 public:
  /// Far above the rounding of squared distances (2e9 * 2^-52) and far below a voxel.
  static constexpr double kSlack = 1e-3;

  PowerSites(const std::vector<Ball>& balls, const Lattice& lattice)
      : balls_(balls), lattice_(lattice) {}

  size_t size() const { return balls_.size(); }

  double value(size_t i, const Coord& p) const {
    const Ball& ball = balls_[i];
    const double dx = lattice_.place(0, p.x()) - ball.x, dy = lattice_.place(1, p.y()) - ball.y,
                 dz = lattice_.place(2, p.z()) - ball.z;
    return dx * dx + dy * dy + dz * dz - ball.radius * ball.radius;
  }

  ValueRange range(size_t i, const Coord& lower, int edge) const {
    const Ball& ball = balls_[i];
    const double center[3] = {ball.x, ball.y, ball.z};
    double nearest = 0, farthest = 0;
    for (int axis = 0; axis < 3; ++axis) {
      const double below = center[axis] - lattice_.place(axis, lower[axis]);
      const double above = lattice_.place(axis, lower[axis] + edge - 1) - center[axis];
      const double outside = std::max({0.0, -below, above < 0 ? -above : 0.0});
      const double reach = std::max(below, above);
      nearest += outside * outside;
      farthest += reach * reach;
    }
    const double square = ball.radius * ball.radius;
    return {nearest - square, farthest - square};
  }

 private:
  const std::vector<Ball>& balls_;
  const Lattice& lattice_;
};

}  // namespace

Int32Tree::Ptr powerCells(const MaskTree& object, const std::vector<Ball>& balls,
                          Interrupter* interrupter, const Lattice& lattice) {
  return LeastCells(PowerSites(balls, lattice)).label(object, interrupter);
}

}  // namespace vdb_madf::detail
