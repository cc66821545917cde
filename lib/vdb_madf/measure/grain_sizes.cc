// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/measure/grain_sizes.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace vdb_madf {

namespace {

/// \p sizes ascending.
double diameterAtShare(const std::vector<int64_t>& sizes, int64_t all, double share) {
  int64_t below = 0;
  for (const int64_t size : sizes) {
    below += size;
    if (double(below) >= share * double(all)) return std::cbrt(6 * double(size) / M_PI);
  }
  return std::numeric_limits<double>::quiet_NaN();
}

}  // namespace

GrainSizes grainSizes(std::vector<int64_t> grainVoxels) {
  std::sort(grainVoxels.begin(), grainVoxels.end());
  GrainSizes sizes;
  for (const int64_t voxels : grainVoxels) {
    if (voxels >= kDustVoxels) break;
    ++sizes.dustGrains;
    sizes.dustVoxels += voxels;
  }
  const int64_t all = std::accumulate(grainVoxels.begin(), grainVoxels.end(), int64_t(0));
  sizes.d10 = diameterAtShare(grainVoxels, all, 0.1);
  sizes.d50 = diameterAtShare(grainVoxels, all, 0.5);
  sizes.d90 = diameterAtShare(grainVoxels, all, 0.9);
  return sizes;
}

}  // namespace vdb_madf
