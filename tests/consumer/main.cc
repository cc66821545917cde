// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

// What a program that links the library looks like: it segments a ball.

#include <iostream>

#include "vdb_madf/segment.h"
#include "vdb_madf/vdb_file.h"

int main() {
  vdb_madf::initialize();
  const auto ball = vdb_madf::MaskGrid::create();
  auto voxels = ball->getAccessor();
  constexpr int kRadius = 10;
  for (int x = -kRadius; x <= kRadius; ++x)
    for (int y = -kRadius; y <= kRadius; ++y)
      for (int z = -kRadius; z <= kRadius; ++z)
        if (x * x + y * y + z * z < kRadius * kRadius) voxels.setValueOn({x, y, z});

  const vdb_madf::Segmentation result = vdb_madf::segment(*ball);
  std::cout << result.counts.grains << " grain of " << result.grain->activeVoxelCount()
            << " voxels\n";
  const bool right = result.counts.grains == 1 &&
                     result.grain->activeVoxelCount() == ball->activeVoxelCount() &&
                     result.grain->tree().getValue({0, 0, 0}) == 1;
  return right ? 0 : 1;
}
