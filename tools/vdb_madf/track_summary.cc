// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "track_output.h"

#include <algorithm>
#include <cstdio>

namespace vdb_madf::tools {

namespace {

template <typename Items, typename Fate>
int64_t countOf(const Items& items, Fate fate) {
  return std::count_if(items.begin(), items.end(),
                       [&](const auto& item) { return item.fate == fate; });
}

/// How many have each fate, as far as there are any.
template <typename Items, typename Fates>
Json fatesOf(const Items& items, const Fates& fates) {
  Json json = Json::object();
  json["all"] = items.size();
  for (const auto fate : fates)
    if (const int64_t count = countOf(items, fate)) json[toString(fate)] = count;
  return json;
}

double percent(int64_t part, int64_t whole) {
  return whole > 0 ? 100.0 * double(part) / double(whole) : 0.0;
}

/// Of the bonds that are decided, and what it is at least and at most if some are not.
Json brokenJson(const BrokenBonds& bonds) {
  Json json = Json::object();
  if (bonds.kept + bonds.broken == 0) return json;
  json["bonds"] = bonds.all();
  json["share"] = double(bonds.broken) / double(bonds.kept + bonds.broken);
  json["at_least"] = double(bonds.broken) / double(bonds.all());
  json["at_most"] = double(bonds.broken + bonds.unknown) / double(bonds.all());
  return json;
}

/// Of those that were followed.
int64_t cutGrains(const Tracks& t) {
  return std::count_if(t.moves.begin(), t.moves.end(),
                       [](const GrainMove& move) { return move.isCut; });
}

void addMotion(Json& json, const Tracks& t, const TrackOptions& options) {
  json["motion"] = toString(*t.motion);
  if (t.whole) {
    Json rows = Json::array();
    for (int row = 0; row < 3; ++row)
      rows.push_back({t.whole->linear(row, 0), t.whole->linear(row, 1), t.whole->linear(row, 2),
                      t.whole->shift[row]});
    json["motion_of_whole"] = rows;
  }
  json["cut_grains"] = cutGrains(t);
  json["gap"] = options.gap;
  json["sure_faces"] = options.sureFaces;
}

void printFates(const char* what, const Json& fates) {
  std::printf("%s  %s", what, fates["all"].dump().c_str());
  const char* before = ": ";
  for (const auto& [fate, count] : fates.items()) {
    if (fate == "all") continue;
    std::printf("%s%s %s", before, count.dump().c_str(), fate.c_str());
    before = ", ";
  }
  std::printf("\n");
}

void printMotion(const Tracks& t) {
  std::printf("motion         %s\n", toString(*t.motion));
  if (!t.whole) return;
  const Strain strain = strainOf(t.whole->linear);
  std::printf(
      "of the whole   turned by %.2f degrees, strain %.4f (volumetric), %.4f (deviatoric)\n",
      strain.turn.length(), strain.volumetric, strain.deviatoric);
}

void printBroken(const BrokenBonds& bonds, int64_t sureFaces) {
  const int64_t decided = bonds.kept + bonds.broken;
  if (decided == 0) return;
  std::printf(
      "broken         %.2f %% of the bonds of %lld faces or more, %.2f to %.2f %% if some are "
      "lost or undecided\n",
      percent(bonds.broken, decided), static_cast<long long>(sureFaces),
      percent(bonds.broken, bonds.all()), percent(bonds.broken + bonds.unknown, bonds.all()));
}

void printShift(const TrackArguments& o, const Tracks& t) {
  std::printf("shift          %d,%d,%d voxels%s\n", t.shift.x(), t.shift.y(), t.shift.z(),
              o.track.shift ? "" : ", found");
  std::printf("in common      %.2f %% of the labeled voxels before, %.2f %% of those after\n",
              percent(t.commonVoxels, t.voxelsBefore), percent(t.commonVoxels, t.voxelsAfter));
}

}  // namespace

Json summaryOf(const TrackArguments& o, const Tracks& t) {
  Json json;
  json["before"] = o.before.path;
  json["after"] = o.after.path;
  if (!o.out.empty()) json["output"] = o.out;
  if (t.motion) {
    addMotion(json, t, o.track);
    json["min_faces"] = o.track.minFaces;
  } else {
    json["shift"] = coordJson(t.shift);
    json["share"] = o.track.share;
    json["min_faces"] = o.track.minFaces;
    json["voxels_before"] = t.voxelsBefore;
    json["voxels_after"] = t.voxelsAfter;
    json["common_voxels"] = t.commonVoxels;
  }
  json["grains_before"] = fatesOf(t.before, kGrainFates);
  json["grains_after"] = fatesOf(t.after, kGrainFates);
  json["bonds_before"] = fatesOf(t.bondsBefore, kBondFates);
  json["bonds_after"] = fatesOf(t.bondsAfter, kBondFates);
  if (t.motion) json["broken_bonds"] = brokenJson(brokenBonds(t, o.track.sureFaces));
  return json;
}

void print(const TrackArguments& o, const Tracks& t, const Json& json) {
  if (t.motion)
    printMotion(t);
  else
    printShift(o, t);
  printFates("grains before", json["grains_before"]);
  printFates("grains after ", json["grains_after"]);
  printFates("bonds before ", json["bonds_before"]);
  printFates("bonds after  ", json["bonds_after"]);
  if (t.motion && cutGrains(t) > 0)
    std::printf("cut            %s that scans end within: displacements are as neighbors say\n",
                counted(cutGrains(t), "grain").c_str());
  if (t.motion) printBroken(brokenBonds(t, o.track.sureFaces), o.track.sureFaces);
}

}  // namespace vdb_madf::tools
