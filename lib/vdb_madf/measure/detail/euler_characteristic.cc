// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/measure/detail/euler_characteristic.h"

#include <atomic>

#include "vdb_madf/base/detail/bits.h"
#include "vdb_madf/base/detail/parallel.h"
#include "vdb_madf/leaves/detail/leaf_neighborhood.h"
#include "vdb_madf/leaves/detail/voxels.h"

namespace vdb_madf::detail {

namespace {

int64_t count(uint64_t word) {
  return countBits(word);
}

/// Bit y*8 + z: the voxel (y, z) of a slice, and those one further along y, z and both.
struct Slice {
  uint64_t here = 0, y = 0, z = 0, yz = 0;
};

uint64_t nextY(uint64_t word, uint64_t beyond) {
  return word >> 8 | beyond << 56;
}
uint64_t nextZ(uint64_t word, uint64_t beyond) {
  return (word >> 1 & ~kLastZ) | (beyond & kFirstZ) << 7;
}

}  // namespace

int64_t eulerCharacteristic(const LeafIndex& index, const LeafLayers& layers,
                            Interrupter* interrupter) {
  std::atomic<int64_t> sum{0};
  parallelFor(index.leafCount(), kLightLeafGrain, interrupter, [&](size_t begin, size_t end) {
    LeafNeighborhood neighborhood(index);
    int64_t part = 0;
    for (size_t leaf = begin; leaf < end; ++leaf) {
      if (!layers.hold(index.origin(leaf))) continue;
      const auto& around = neighborhood.around(leaf);
      const auto word = [&](int x, int dy, int dz) -> uint64_t {
        const uint32_t from = around[size_t((1 + (x >> 3)) * 9 + (1 + dy) * 3 + 1 + dz)];
        return from == LeafIndex::kNone ? 0 : index.mask(from)[size_t(x & 7)];
      };
      const auto slice = [&](int x) {
        const uint64_t own = word(x, 0, 0), z = word(x, 0, 1);
        const uint64_t y = nextY(own, word(x, 1, 0));
        return Slice{own, y, nextZ(own, z), nextZ(y, nextY(z, word(x, 1, 1)))};
      };
      Slice a = slice(0);
      for (int x = 0; x < 8; ++x) {
        const Slice b = slice(x + 1);
        const uint64_t squareYz = a.here & a.y & a.z & a.yz;
        part += count(a.here) - count(a.here & b.here) - count(a.here & a.y) - count(a.here & a.z);
        part += count(squareYz) + count(a.here & a.y & b.here & b.y) +
                count(a.here & a.z & b.here & b.z);
        part -= count(squareYz & b.here & b.y & b.z & b.yz);
        a = b;
      }
    }
    sum += part;  // integers: any order
  });
  return sum;
}

}  // namespace vdb_madf::detail
