// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

// What a program looks like that has its own arrays and wants nothing of OpenVDB: it hands a mask
// in and gets labels out, and takes a second to compile.

#include "vdb_madf/volumes/segment_array.h"

#if defined(OPENVDB_GRID_HAS_BEEN_INCLUDED) || defined(OPENVDB_TYPES_HAS_BEEN_INCLUDED)
#error "the header for arrays brought OpenVDB along"
#endif

bool segmentsArrays() {
  constexpr int kSide = 24;
  std::vector<uint8_t> mask(kSide * kSide * kSide);
  for (int z = 4; z < 20; ++z)
    for (int y = 4; y < 20; ++y)
      for (int x = 4; x < 20; ++x) mask[size_t((z * kSide + y) * kSide + x)] = 1;
  const vdb_madf::ArraySegmentation result =
      vdb_madf::segmentArray(mask.data(), {kSide, kSide, kSide});
  return result.grainVoxels == std::vector<int64_t>{16 * 16 * 16} && result.labels[0] == 0 &&
         result.labels[size_t((12 * kSide + 12) * kSide + 12)] == 1;
}
