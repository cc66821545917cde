// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

// From a mask to the sizes of its grains: three balls that touch in a row are cut at their necks.

#include <cmath>
#include <iostream>

#include "vdb_madf/segmentation/initialize.h"
#include "vdb_madf/segmentation/segment.h"

int main() {
  // OpenVDB wants this once in a program, before any of its grids is used.
  vdb_madf::initialize();

  // The object is the active voxels of a mask grid, which are set like this. A program with a file
  // reads it by loadObject() of volumes/load_object.h; one with an array of all voxels needs no
  // grid: segmentArray() of volumes/segment_array.h.
  const auto object = vdb_madf::MaskGrid::create();
  auto voxels = object->getAccessor();
  const auto addBall = [&](const vdb_madf::Coord& center, int radius) {
    for (int x = -radius; x <= radius; ++x)
      for (int y = -radius; y <= radius; ++y)
        for (int z = -radius; z <= radius; ++z)
          if (x * x + y * y + z * z < radius * radius)
            voxels.setValueOn(center + vdb_madf::Coord(x, y, z));
  };
  addBall({0, 0, 0}, 14);
  addBall({24, 0, 0}, 12);
  addBall({44, 0, 0}, 10);

  // The defaults suit most samples. Labels are 1, 2, ... in a grid of their own.
  const vdb_madf::Segmentation cut = vdb_madf::segment(*object);

  std::cout << "grain  voxels  diameter of the ball of this volume\n";
  constexpr double kPi = 3.14159265358979323846;
  for (size_t i = 0; i < cut.grainVoxels.size(); ++i) {
    const int64_t size = cut.grainVoxels[i];
    std::cout << i + 1 << "      " << size << "   " << std::cbrt(6 * double(size) / kPi) << "\n";
  }

  // Any voxel can be asked for its grain.
  const int grainInTheMiddle = cut.grain->tree().getValue({24, 0, 0});
  std::cout << "the middle ball is grain " << grainInTheMiddle << "\n";
  return cut.counts.grains == 3 && grainInTheMiddle == 2 ? 0 : 1;
}
