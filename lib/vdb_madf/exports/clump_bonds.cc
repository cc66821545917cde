// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/exports/clump_bonds.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "vdb_madf/base/errors.h"
#include "vdb_madf/files/detail/output_stream.h"
#include "vdb_madf/files/file_name.h"
#include "vdb_madf/grids/detail/world_transform.h"

namespace vdb_madf {

namespace {

/// The place of a label's clump; clumps.size() if there is none.
size_t find(const std::vector<Clump>& clumps, int32_t label) {
  const auto found =
      std::lower_bound(clumps.begin(), clumps.end(), label,
                       [](const Clump& clump, int32_t wanted) { return clump.label < wanted; });
  return found != clumps.end() && found->label == label ? size_t(found - clumps.begin())
                                                        : clumps.size();
}

/// Chooses the balls of a bond: places within their clumps.
void chooseBalls(const Clump& first, const Clump& second, const openvdb::Vec3d& edges,
                 ClumpBond& bond) {
  double nearest = std::numeric_limits<double>::infinity();
  for (size_t i = 0; i < first.balls.size(); ++i)
    for (size_t j = 0; j < second.balls.size(); ++j) {
      const Clump::Ball &a = first.balls[i], &b = second.balls[j];
      const double distance = ((b.center - a.center).asVec3d() * edges).length(),
                   gap = distance - std::sqrt(a.squaredRadius) - std::sqrt(b.squaredRadius);
      if (gap >= nearest) continue;
      nearest = gap;
      bond.firstBall = i;
      bond.secondBall = j;
      bond.distance = distance;
    }
}

}  // namespace

std::vector<ClumpBond> clumpBonds(const std::vector<Clump>& clumps,
                                  const std::vector<BondMeasures>& bonds,
                                  const openvdb::math::Transform& transform) {
  const openvdb::Vec3d edges = detail::proportions(transform);
  // Of each clump: its number among those with balls, and that of its first ball among all.
  std::vector<size_t> numbers, firstBalls;
  size_t number = 0, count = 0;
  for (const Clump& clump : clumps) {
    numbers.push_back(number);
    firstBalls.push_back(count);
    number += !clump.balls.empty();
    count += clump.balls.size();
  }
  std::vector<ClumpBond> result;
  for (const BondMeasures& measures : bonds) {
    const size_t first = find(clumps, measures.first), second = find(clumps, measures.second);
    if (first == clumps.size() || second == clumps.size()) continue;
    if (clumps[first].balls.empty() || clumps[second].balls.empty()) continue;
    ClumpBond bond;
    chooseBalls(clumps[first], clumps[second], edges, bond);
    bond.firstClump = numbers[first];
    bond.secondClump = numbers[second];
    bond.firstBall += firstBalls[first];
    bond.secondBall += firstBalls[second];
    bond.measures = measures;
    result.push_back(bond);
  }
  return result;
}

void writeClumpBonds(const std::string& path, const std::vector<ClumpBond>& bonds,
                     const openvdb::math::Transform& transform, Interrupter* interrupter) {
  const detail::WorldTransform world = detail::worldTransform(transform);
  const double edge = world.shortestEdge();
  if (fileEnding(path) != ".csv")
    throw InvalidInput(path + ": bonds of clumps are written as .csv");
  detail::OutputStream out(path, interrupter);
  out.text(
      "bond,first,second,first_clump,second_clump,first_ball,second_ball,distance,"
      "area,radius,centroid_x,centroid_y,centroid_z,normal_x,normal_y,normal_z\n");
  size_t row = 0;
  for (const ClumpBond& bond : bonds) {
    out.number(++row);
    for (const int32_t grain : {bond.measures.first, bond.measures.second})
      out.text("," + std::to_string(grain));
    for (const size_t place : {bond.firstClump, bond.secondClump, bond.firstBall, bond.secondBall})
      out.text("," + std::to_string(place));
    const openvdb::Vec3d center = world.origin + world.edges * bond.measures.centroid,
                         normal = bond.measures.normal;
    for (const double number : {edge * bond.distance, edge * edge * bond.measures.area,
                                edge * bond.measures.equivalentRadius, center.x(), center.y(),
                                center.z(), normal.x(), normal.y(), normal.z()})
      out.text("," + detail::shortestDecimal(number));
    out.text("\n");
  }
  out.commit();
}

}  // namespace vdb_madf
