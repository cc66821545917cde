// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/leaves/detail/leaf_faces.h"

#include "support/catch.h"
#include "support/random_case.h"
#include "vdb_madf/leaves/voxel_array.h"

using namespace vdb_madf;
using namespace vdb_madf::test;

TEST_CASE("leaf_faces: each voxel's value at its place, 0 and no bit where there is none",
          "[leaf_faces]") {
  int voxels = 0;
  for (uint64_t seed = 1; seed <= 40; ++seed) {
    const RandomCase c = randomCase(seed, Coord(17, 20, 18));
    INFO(describe(c));
    const LeafIndex index(*toMask(c.object, c.tiles));
    VoxelArray<uint32_t> values(size_t(index.voxelCount()));
    for (size_t i = 0; i < values.size(); ++i) values[i] = uint32_t(i + 1);
    for (uint32_t leaf = 0; leaf < index.leafCount(); ++leaf)
      for (int axis = 0; axis < 3; ++axis)
        for (int position = 0; position < 8; ++position) {
          uint32_t face[64];
          detail::copyFace(index, values.data(), leaf, axis, position, face);
          const uint64_t mask = detail::faceMask(index, leaf, axis, position);
          for (int i = 0; i < 64; ++i) {
            Coord p = index.origin(leaf);
            p[axis] += position;
            p[axis == 0 ? 1 : 0] += i >> 3;
            p[axis == 2 ? 1 : 2] += i & 7;
            const auto voxel = index.findVoxel(p);
            voxels += voxel.has_value();
            REQUIRE(face[i] == (voxel ? uint32_t(index.rank(*voxel) + 1) : 0));
            REQUIRE((mask >> i & 1) == voxel.has_value());
          }
        }
    uint32_t face[64];
    detail::copyFace(index, values.data(), LeafIndex::kNone, 1, 0, face);
    CHECK(std::all_of(face, face + 64, [](uint32_t value) { return value == 0; }));
    CHECK(detail::faceMask(index, LeafIndex::kNone, 2, 7) == 0);
  }
  CHECK(voxels > 10000);
}
