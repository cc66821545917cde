// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "input_options.h"
#include "json_file.h"
#include "vdb_madf/matching/track.h"
#include "vdb_madf/measure/grain_network.h"

namespace vdb_madf::tools {

/// What is typed for track.
struct TrackArguments {
  InputOptions before, after;
  std::vector<InputOptions> later;  // filled by parsing a series: each scan but the first
  std::vector<std::string> more;    // of a series: further scans, and the folder
  TrackOptions track;
  std::string out, shift, motion, json, grains, links, bonds, phi, network,
      minFaces = "1", sureFaces = std::to_string(track.sureFaces);
};

/// What --json writes.
Json summaryOf(const TrackArguments& o, const Tracks& t);
/// Says the same, by what summaryOf() gives.
void print(const TrackArguments& o, const Tracks& t, const Json& json);

// The tables of the verb track, as CSV.

/// Grains of either side: with a motion their moves, else what they overlap.
std::string trackedGrainTable(const Tracks& tracks);
/// Pairs of grains that have voxels in common.
std::string trackLinkTable(const Tracks& tracks);
/// Bonds of either side.
std::string trackedBondTable(const Tracks& tracks);

/// The motion of grains as a field of Phi, tab-separated, as spam's discrete volume correlation
/// takes it for a first guess (spam.helpers.tsvio): a row for each number from 0 to the largest
/// label before, with center, rotation and displacement in voxels of images whose first voxels are
/// these, z before y before x. `returnStatus` is 2 of grains that were followed, 1 of those
/// whose neighbors say where they should be, and -1 of all other numbers, which stay where they
/// are.
/// @pre tracked with a motion
std::string phiTable(const Tracks& tracks, const Coord& firstBefore, const Coord& firstAfter);

/// The grains and bonds of before, with what became of them, for writeNetwork(). Grains have
/// `voxels`, `fate` (its position in GrainFate), `partner` (0: none), `confidence`, `miss`, `cut`,
/// `displacement_x`, `_y`, `_z`, `strain_volumetric`, `strain_deviatoric`, `rotation_x`, `_y`, `_z`
/// (degrees); bonds `faces` and `fate` (its position in BondFate). Places and displacements are in
/// world units. NaN: not known.
/// @pre tracked with a motion
GrainNetwork motionNetwork(const AnyLabels& before, const Tracks& tracks);

}  // namespace vdb_madf::tools
