// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <optional>
#include <string>
#include <vector>

#include "vdb_madf/base/voxel_size.h"
#include "vdb_madf/samples/sample.h"

namespace vdb_madf {

/// A ball of a list, in the list's own unit of length.
struct ListedBall {
  double x = 0, y = 0, z = 0, radius = 1;
};

/// The balls of a text: a line each, `x y z` or `x y z r`, with spaces, tabs or commas between the
/// numbers; without r the radius is 1. A # begins a comment, empty lines are skipped.
/// @param numbered each line has the number of its ball before x; it is skipped
/// @throw InvalidInput that names the line; or if there is no ball
std::vector<ListedBall> parseBalls(const std::string& text, bool numbered = false);

/// Open balls |p - c| < r of given centers, where and how large they are: balls that were measured,
/// or placed by another program. The middle of their bounding box is that of the sample, which is
/// as large as the bounding box, in whole voxels, or cuts out of it what a size says. truth = the
/// power map of the balls, numbered in the order of the list; a ball that owns no voxel is no
/// grain.
struct BallOptions {
  std::vector<ListedBall> balls;
  double radius = 10;                  ///< voxels for each unit of the list; above 0
  std::optional<Coord> size;           ///< none: that of the bounding box
  std::optional<VoxelSize> voxelSize;  ///< need not be cubes: see sample.h
  std::string list = "LIST";           ///< what the metadata calls the list
};
Sample generateBalls(const BallOptions& options, Interrupter* interrupter = nullptr);

}  // namespace vdb_madf
