// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/base/detail/cubes_along.h"

#include <cmath>
#include <string>

#include "vdb_madf/base/errors.h"
#include "vdb_madf/base/limits.h"
#include "vdb_madf/base/memory.h"

namespace vdb_madf::detail {

namespace {

constexpr double kMaxRatio = 256;
/// Products of three edges fit in 64 bits.
constexpr int64_t kMaxEdge = int64_t(1) << 20;
/// Two such fractions are farther apart than this, and the ratio of two decimals nearer to its own.
constexpr double kTolerance = 1e-13;

}  // namespace

CubesAlong::CubesAlong(double voxelEdge, double cubeEdge) {
  const double ratio = voxelEdge / cubeEdge;
  if (!(ratio <= kMaxRatio && ratio >= 1 / kMaxRatio))
    throw InvalidInput("cubes of that size are more than " + std::to_string(int(kMaxRatio)) +
                       " times as long or short as its voxels: take others");
  // The first convergent of its continued fraction that is near enough, or the last that is small.
  int64_t lastVoxel = 1, lastCube = 0;
  double rest = ratio;
  voxel_ = int64_t(rest);
  while (std::abs(double(voxel_) / double(cube_) - ratio) > kTolerance * ratio) {
    rest = 1 / (rest - std::floor(rest));
    const double digit = std::floor(rest), voxel = digit * double(voxel_) + double(lastVoxel),
                 cube = digit * double(cube_) + double(lastCube);
    if (!(voxel <= double(kMaxEdge) && cube <= double(kMaxEdge))) break;
    lastVoxel = voxel_;
    lastCube = cube_;
    voxel_ = int64_t(voxel);
    cube_ = int64_t(cube);
  }
}

int CubesAlong::countFor(int64_t voxels) const {
  if (double(voxels) * double(voxel_) > (double(kMaxExtent) + 0.5) * double(cube_))
    throw InvalidInput("in cubes of that size it would be more than " + std::to_string(kMaxExtent) +
                       " voxels long: take larger ones");
  const int64_t count = (2 * voxels * voxel_ + cube_) / (2 * cube_);
  if (count == 0)
    throw InvalidInput("it is less than half as thick as a cube of that size: take smaller ones");
  return int(count);
}

int64_t CubesAlong::nearestVoxel(int64_t cube) const {
  // Twice its center; a center on the face between two voxels belongs to the lower one.
  return ((2 * cube + 1) * cube_ - 1) / (2 * voxel_);
}

void checkCubes(double voxels, double bytes) {
  const auto available = double(availableMemory());
  if (voxels > double(kMaxLeaves) * 512)
    throw InvalidInput("in cubes of that size it would have more than " +
                       std::to_string(kMaxLeaves * 512) + " voxels: take larger ones");
  if (available > 0 && bytes > available)
    throw InvalidInput("in cubes of that size it would take " + readableBytes(int64_t(bytes)) +
                       " of memory, and " + readableBytes(int64_t(available)) +
                       " are free: take larger ones");
}

}  // namespace vdb_madf::detail
