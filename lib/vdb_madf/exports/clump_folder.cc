// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/exports/clump_folder.h"

#include <fmt/core.h>

#include <array>
#include <cmath>

#include "vdb_madf/base/errors.h"
#include "vdb_madf/files/output_tree.h"
#include "vdb_madf/grids/detail/world_transform.h"
#include "vdb_madf/labels/grain_name.h"

namespace vdb_madf {

namespace {

using openvdb::Vec3d;

/// The axes of inertia of a grain, a right-handed system.
std::array<Vec3d, 3> axesOf(const GrainMeasures& grain) {
  std::array<Vec3d, 3> axes = grain.ellipsoid.axes;
  if (axes[0].cross(axes[1]).dot(axes[2]) < 0) axes[2] = -axes[2];
  return axes;
}

std::string commaLine(double a, double b, double c) {
  return fmt::format("{},{},{}\n", a, b, c);
}

/// \p edge: the shortest of a voxel
std::string inertiaOf(const GrainMeasures& grain, double mass, double edge) {
  std::array<double, 3> squares{};  // means along the axes; an ellipsoid's are L^2 / 20
  for (size_t i = 0; i < 3; ++i) squares[i] = std::pow(edge * grain.ellipsoid.values[i], 2) / 20;
  return commaLine(mass * (squares[1] + squares[2]), 0, 0) +
         commaLine(0, mass * (squares[0] + squares[2]), 0) +
         commaLine(0, 0, mass * (squares[0] + squares[1]));
}

}  // namespace

void writeClumpFolder(const std::string& folder, const std::vector<Clump>& clumps,
                      const std::vector<GrainMeasures>& grains,
                      const openvdb::math::Transform& transform) {
  const detail::WorldTransform world = detail::worldTransform(transform);
  const double edge = world.shortestEdge();
  OutputTree tree(folder);
  std::string places = "grain_id,x,y,z\n";
  for (const Clump& clump : clumps) {
    if (clump.balls.empty()) continue;
    const size_t row = rowOf(grains, clump.label);
    if (row == grains.size() || grains[row].id != clump.label)
      throw InvalidInput(
          fmt::format("grain {} is not among those that were measured", clump.label));
    const GrainMeasures& grain = grains[row];
    const Vec3d center = world.origin + world.edges * grain.centroid;
    const std::array<Vec3d, 3> axes = axesOf(grain);
    std::string balls, directions;
    for (const Clump::Ball& ball : clump.balls) {
      const Vec3d from = world.origin + world.edges * ball.center.asVec3d() - center;
      balls += fmt::format("{},{},{},{}\n", from.dot(axes[0]), from.dot(axes[1]), from.dot(axes[2]),
                           edge * std::sqrt(ball.squaredRadius));
    }
    for (int i = 0; i < 3; ++i) directions += commaLine(axes[0][i], axes[1][i], axes[2][i]);
    const double mass = grain.volume * edge * edge * edge;
    const std::string name = grainName(clump.label);
    tree.write(name + "/Clump/Clump.txt", balls);
    tree.write(name + "/Inertia/Mass.txt", fmt::format("{}\n", mass));
    tree.write(name + "/Inertia/TOI.txt", inertiaOf(grain, mass, edge));
    tree.write(name + "/Inertia/PD.txt", directions);
    places += fmt::format("{},{},{},{}\n", clump.label, center.x(), center.y(), center.z());
  }
  tree.write("places.csv", places);
  tree.commit();
}

}  // namespace vdb_madf
