// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "track_output.h"

#include <algorithm>
#include <cstdint>
#include <sstream>
#include <utility>
#include <vector>

namespace vdb_madf::tools {

namespace {

/// A share with nine digits; empty where there is nothing to have a share of.
void addShare(std::ostream& csv, int64_t part, int64_t whole) {
  csv << ',';
  if (whole > 0) csv << double(part) / double(whole);
}

std::string overlapTable(const Tracks& t) {
  std::ostringstream csv;
  csv.precision(9);
  csv << "side,grain,fate,track,voxels,shared_voxels,links,partner,overlap_voxels,overlap_share\n";
  for (const auto& [side, grains] :
       {std::pair<const char*, const std::vector<TrackedGrain>&>{"before", t.before},
        {"after", t.after}})
    for (const TrackedGrain& g : grains) {
      csv << side << ',' << g.grain << ',' << toString(g.fate) << ',' << g.track << ',' << g.voxels
          << ',' << g.sharedVoxels << ',' << g.links << ',' << g.partner << ',' << g.overlapVoxels;
      addShare(csv, g.overlapVoxels, g.sharedVoxels);
      csv << '\n';
    }
  return csv.str();
}

void addStrain(std::ostream& csv, const GrainMove& move) {
  if (!move.gradient) {
    csv << std::string(14, ',');
    return;
  }
  const auto add = [&](double value) { csv << ',' << value; };
  for (int n = 0; n < 9; ++n) add((*move.gradient)(n / 3, n % 3));
  const Strain strain = strainOf(*move.gradient);
  add(strain.volumetric);
  add(strain.deviatoric);
  for (int axis = 0; axis < 3; ++axis) add(strain.turn[axis]);
}

/// What a grain's motion was; empty cells for what is not known.
void addMove(std::ostream& csv, const GrainMove* move) {
  if (!move) {
    csv << std::string(21, ',');
    return;
  }
  const auto add = [&](double value) { csv << ',' << value; };
  add(move->confidence);
  add(move->miss);
  for (int axis = 0; axis < 3; ++axis) add(move->displacement[axis]);
  csv << ',' << move->neighbors;
  addStrain(csv, *move);
  csv << ',' << int(move->isCut);
}

/// With a motion. What was followed has its motion on either side.
std::string moveTable(const Tracks& t) {
  std::ostringstream csv;
  csv.precision(9);
  csv << "side,grain,fate,track,voxels,partner,confidence,miss,displacement_x,displacement_y,"
         "displacement_z,neighbors,f_xx,f_xy,f_xz,f_yx,f_yy,f_yz,f_zx,f_zy,f_zz,"
         "strain_volumetric,strain_deviatoric,rotation_x,rotation_y,rotation_z,cut\n";
  const MoveOf move = moveOf(t);
  for (const auto& [side, grains] :
       {std::pair<const char*, const std::vector<TrackedGrain>&>{"before", t.before},
        {"after", t.after}})
    for (const TrackedGrain& g : grains) {
      csv << side << ',' << g.grain << ',' << toString(g.fate) << ',' << g.track << ',' << g.voxels
          << ',' << g.partner;
      addMove(csv, move(g));
      csv << '\n';
    }
  return csv.str();
}

/// Of one of the grains of a side.
int64_t sharedVoxels(const std::vector<TrackedGrain>& grains, int32_t grain) {
  return std::lower_bound(grains.begin(), grains.end(), grain,
                          [](const TrackedGrain& g, int32_t number) { return g.grain < number; })
      ->sharedVoxels;
}

}  // namespace

std::string trackedGrainTable(const Tracks& t) {
  return t.motion ? moveTable(t) : overlapTable(t);
}

std::string trackLinkTable(const Tracks& t) {
  std::ostringstream csv;
  csv.precision(9);
  csv << "before,after,voxels,share_before,share_after,link\n";
  for (const GrainOverlap& overlap : t.overlaps) {
    csv << overlap.before << ',' << overlap.after << ',' << overlap.voxels;
    addShare(csv, overlap.voxels, sharedVoxels(t.before, overlap.before));
    addShare(csv, overlap.voxels, sharedVoxels(t.after, overlap.after));
    csv << ',' << int(overlap.isLink) << '\n';
  }
  return csv.str();
}

std::string trackedBondTable(const Tracks& t) {
  std::ostringstream csv;
  csv << "side,first,second,faces,shared_faces,fate\n";
  for (const auto& [side, bonds] :
       {std::pair<const char*, const std::vector<TrackedBond>&>{"before", t.bondsBefore},
        {"after", t.bondsAfter}})
    for (const TrackedBond& bond : bonds)
      csv << side << ',' << bond.first << ',' << bond.second << ',' << bond.faces << ','
          << bond.sharedFaces << ',' << toString(bond.fate) << '\n';
  return csv.str();
}

}  // namespace vdb_madf::tools
