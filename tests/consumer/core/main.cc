// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

// What a program that links the method alone looks like: it segments two balls that touch.

#include <iostream>

#include "vdb_madf/segmentation/initialize.h"
#include "vdb_madf/segmentation/segment.h"

int main() {
  vdb_madf::initialize();
  const auto balls = vdb_madf::MaskGrid::create();
  auto voxels = balls->getAccessor();
  constexpr int kRadius = 10, kDistance = 19;
  for (int x = -kRadius; x <= kRadius; ++x)
    for (int y = -kRadius; y <= kRadius; ++y)
      for (int z = -kRadius; z <= kRadius; ++z)
        if (x * x + y * y + z * z < kRadius * kRadius) {
          voxels.setValueOn({x, y, z});
          voxels.setValueOn({x + kDistance, y, z});
        }

  const vdb_madf::Segmentation result = vdb_madf::segment(*balls);
  std::cout << result.counts.grains << " grains of " << result.grain->activeVoxelCount()
            << " voxels\n";
  const auto& labels = result.grain->tree();
  return result.counts.grains == 2 && labels.getValue({0, 0, 0}) == 1 &&
                 labels.getValue({kDistance, 0, 0}) == 2
             ? 0
             : 1;
}
