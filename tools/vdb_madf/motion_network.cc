// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "track_output.h"

#include <algorithm>
#include <limits>
#include <string>

#include "vdb_madf/labels/grain_colors.h"

namespace vdb_madf::tools {

namespace {

using Column = GrainNetwork::Column;

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

/// A column of one number for each item.
template <typename Items, typename Number>
Column column(const std::string& name, const Items& items, const Number& number,
              bool isCount = false) {
  Column result{name, {}, isCount};
  for (size_t n = 0; n < items.size(); ++n) result.values.push_back(double(number(n)));
  return result;
}

/// Of the grains that were followed, along x, y and z.
void addMoves(const Int32Grid& about, const Tracks& tracks, std::vector<Column>& columns) {
  const double edge = about.voxelSize()[0];  // of a cube
  const auto& moves = tracks.moves;
  const auto add = [&](const std::string& name, const auto& number) {
    columns.push_back(column(
        name, moves, [&](size_t n) { return moves[n].confidence > 0 ? number(moves[n]) : kNone; }));
  };
  const auto addStrain = [&](const std::string& name, const auto& number) {
    add(name, [&](const GrainMove& move) {
      return move.gradient ? number(strainOf(*move.gradient)) : kNone;
    });
  };
  add("confidence", [](const GrainMove& move) { return move.confidence; });
  add("miss", [&](const GrainMove& move) { return edge * move.miss; });
  for (int axis = 0; axis < 3; ++axis)
    add(std::string("displacement_") + "xyz"[axis],
        [&](const GrainMove& move) { return edge * move.displacement[axis]; });
  columns.push_back(column(
      "cut", moves, [&](size_t n) { return moves[n].isCut; }, true));
  addStrain("strain_volumetric", [](const Strain& strain) { return strain.volumetric; });
  addStrain("strain_deviatoric", [](const Strain& strain) { return strain.deviatoric; });
  for (int axis = 0; axis < 3; ++axis)
    addStrain(std::string("rotation_") + "xyz"[axis],
              [&](const Strain& strain) { return strain.turn[axis]; });
}

}  // namespace

GrainNetwork motionNetwork(const AnyLabels& before, const Tracks& tracks) {
  const GrainColors colors = applied(before, [](const auto& all) { return grainColors(all); });
  const Int32Grid& about = aboutOf(before);
  const auto& grains = tracks.before;
  const auto& bonds = tracks.bondsBefore;
  GrainNetwork network;
  for (size_t n = 0; n < grains.size(); ++n) {
    network.grains.push_back(grains[n].grain);
    network.centers.push_back(about.transform().indexToWorld(tracks.moves[n].center));
    network.colors.push_back(colors.colorOf(grains[n].grain));
  }
  const auto positionOf = [&](int32_t grain) {
    return uint32_t(std::lower_bound(network.grains.begin(), network.grains.end(), grain) -
                    network.grains.begin());
  };
  for (const TrackedBond& bond : bonds)
    network.bonds.push_back({positionOf(bond.first), positionOf(bond.second)});
  auto& columns = network.grainColumns;
  columns.push_back(column(
      "voxels", grains, [&](size_t n) { return grains[n].voxels; }, true));
  columns.push_back(column(
      "fate", grains, [&](size_t n) { return int(grains[n].fate); }, true));
  columns.push_back(column(
      "partner", grains, [&](size_t n) { return grains[n].partner; }, true));
  addMoves(about, tracks, columns);
  network.bondColumns.push_back(column(
      "faces", bonds, [&](size_t n) { return bonds[n].faces; }, true));
  network.bondColumns.push_back(column(
      "fate", bonds, [&](size_t n) { return int(bonds[n].fate); }, true));
  return network;
}

}  // namespace vdb_madf::tools
