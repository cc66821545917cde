// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "track_output.h"

#include <fmt/core.h>

#include <sstream>

#include "vdb_madf/base/errors.h"

namespace vdb_madf::tools {

namespace {

enum Status { kFollowed = 2, kExpected = 1, kUnknown = -1 };

void addRow(std::ostream& tsv, int32_t label, const openvdb::Vec3d& center,
            const openvdb::Mat3d& rotation, const openvdb::Vec3d& displacement, Status status) {
  tsv << label;
  for (const int axis : {2, 1, 0}) tsv << '\t' << center[axis];
  for (const int row : {2, 1, 0}) {
    for (const int column : {2, 1, 0}) tsv << '\t' << rotation(row, column);
    tsv << '\t' << displacement[row];
  }
  tsv << "\t0\t0\t" << int(status) << "\t0\n";
}

}  // namespace

std::string phiTable(const Tracks& tracks, const Coord& firstBefore, const Coord& firstAfter) {
  std::ostringstream tsv;
  tsv.precision(9);
  tsv << "Label\tZpos\tYpos\tXpos\tFzz\tFzy\tFzx\tZdisp\tFyz\tFyy\tFyx\tYdisp\tFxz\tFxy\tFxx\tXdisp"
         "\terror\titerations\treturnStatus\tdeltaPhiNorm\n";
  const openvdb::Vec3d zero(0), between = (firstBefore - firstAfter).asVec3d();
  constexpr int32_t kMostRows = 10'000'000;  // of what spam reads back
  if (!tracks.before.empty() && tracks.before.back().grain > kMostRows)
    throw InvalidInput(fmt::format(
        "--phi has a row for each number up to the largest label before, {}: renumber the labels "
        "first (edit --renumber)",
        tracks.before.back().grain));
  int32_t next = 0;
  for (size_t n = 0; n < tracks.before.size(); ++n) {
    const int32_t label = tracks.before[n].grain;
    for (; next < label; ++next)
      addRow(tsv, next, zero, openvdb::Mat3d::identity(), zero, kUnknown);
    const GrainMove& move = tracks.moves[n];
    const auto rotation = move.gradient ? rotationOf(*move.gradient) : openvdb::Mat3d::identity();
    const Status status = move.confidence > 0 ? kFollowed : move.isPlaced ? kExpected : kUnknown;
    addRow(tsv, next++, move.center - firstBefore.asVec3d(), rotation, move.displacement + between,
           status);
  }
  return tsv.str();
}

}  // namespace vdb_madf::tools
