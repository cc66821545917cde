// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/method/power_map.h"

#include <algorithm>
#include <utility>

#include "vdb_madf/base/detail/simd.h"
#include "vdb_madf/leaves/detail/leaf_values.h"
#include "vdb_madf/leaves/detail/pencil.h"
#include "vdb_madf/method/detail/metric.h"
#include "vdb_madf/method/detail/passage.h"
#include "vdb_madf/method/detail/power_passes.h"
#include "vdb_madf/method/kernels/lower_envelope.h"

namespace vdb_madf {

namespace {

constexpr size_t kSlab = detail::kEnvelopeSlab;
static_assert(kUncovered == detail::kNotNegative);

/// What one thread works with.
template <typename Key>
struct Scratch {
  std::vector<uint32_t> leaves;  // of the pencil
  detail::EnvelopeRows<Key> rows;
};

template <int Axis, typename Key>
VDB_MADF_SIMD void gather(const LeafIndex& index, const PowerMap& map, Scratch<Key>& s) {
  int32_t power[512];
  VoxelId site[512];
  for (size_t i = 0; i < s.leaves.size(); ++i) {
    const uint32_t leaf = s.leaves[i];
    detail::expandLeaf(index.mask(leaf), map.power.data() + index.firstRank(leaf), power);
    detail::copyToSlabs<Axis>(power, kSlab, s.rows.power.data() + (i * 8 + 1) * kSlab);
    if (Axis == 2)  // before the first pass every voxel is its own site
      for (uint32_t k = 0; k < 512; ++k) site[k] = leaf * 512 + k;
    else
      detail::expandLeaf(index.mask(leaf), map.site.data() + index.firstRank(leaf), site);
    detail::copyToSlabs<Axis>(site, kSlab, s.rows.site.data() + i * 8 * kSlab);
  }
}

template <int Axis, typename Key>
VDB_MADF_SIMD void scatter(const LeafIndex& index, const Scratch<Key>& s, PowerMap& map) {
  int32_t power[512];
  VoxelId site[512];
  for (size_t i = 0; i < s.leaves.size(); ++i) {
    const uint32_t leaf = s.leaves[i];
    detail::copyFromSlabs<Axis>(s.rows.power.data() + (i * 8 + 1) * kSlab, kSlab, power);
    detail::copyFromSlabs<Axis>(s.rows.site.data() + i * 8 * kSlab, kSlab, site);
    detail::packLeaf(index.mask(leaf), power, map.power.data() + index.firstRank(leaf));
    detail::packLeaf(index.mask(leaf), site, map.site.data() + index.firstRank(leaf));
  }
}

/// D of all sites, from their partial power: the passes before this one have moved away from the
/// site along z, then y. `origin` is that of the pencil's first leaf.
template <int Axis, typename Key>
VDB_MADF_SIMD void computeRadii(const LeafIndex& index, const Coord& origin,
                                const VoxelWeights& weights, Scratch<Key>& s) {
  const Coord* origins = &index.origin(0);
  for (size_t t = 0; t < s.leaves.size() * 8; ++t) {
    const int32_t* power = s.rows.power.data() + (t + 1) * kSlab;
    const VoxelId* site = s.rows.site.data() + t * kSlab;
    int32_t* radius2 = s.rows.radius2.data() + (t + 1) * kSlab;
    for (int row = 0; row < 64; ++row) {
      int32_t away = 0;
      if (Axis != 2) {  // rows: x*8 + z along y, y*8 + z along x
        const Coord& leaf = origins[leafOf(site[row])];
        const int dz = leaf.z() + int(site[row] & 7) - (origin.z() + (row & 7));
        const int dy = leaf.y() + int(bitOf(site[row]) >> 3) - (origin.y() + (row >> 3));
        away = detail::squaredAlong(dz, weights.z) +
               (Axis == 0 ? detail::squaredAlong(dy, weights.y) : 0);
      }
      radius2[row] = away - power[row];
    }
  }
}

template <int Axis, typename Key>
void sweep(const LeafIndex& index, Key multiplier, PowerMap& map, Interrupter* interrupter) {
  const std::vector<uint32_t> starts = detail::pencilStarts(index, Axis);
  detail::PerThread<Scratch<Key>> scratches;
  detail::parallelFor(starts.size(), detail::kPencilGrain, interrupter,
                      [&](size_t begin, size_t end) {
                        Scratch<Key>& s = scratches.local();
                        for (size_t p = begin; p < end; ++p) {
                          detail::collectPencil(index, Axis, starts[p], s.leaves);
                          const int length = int(s.leaves.size()) * 8;
                          s.rows.resize(size_t(length));
                          gather<Axis, Key>(index, map, s);
                          computeRadii<Axis, Key>(index, index.origin(starts[p]), map.weights, s);
                          detail::lowerEnvelopes<Axis + 1>(length, multiplier, map.weights, s.rows);
                          scatter<Axis, Key>(index, s, map);
                        }
                      });
}

template <typename Key>
void sweepAll(const LeafIndex& index, Key multiplier, PowerMap& map, Interrupter* interrupter) {
  detail::WorkPart first(interrupter, 0, 33), second(interrupter, 33, 66),
      third(interrupter, 66, 100);
  sweep<2, Key>(index, multiplier, map, &first);
  sweep<1, Key>(index, multiplier, map, &second);
  sweep<0, Key>(index, multiplier, map, &third);
}

/// Do products of a difference of keys and one of positions fit in 64 bits?
bool fits64Bits(const LeafIndex& index, const VoxelWeights& weights, int32_t largestSquaredRadius) {
  for (int axis = 0; axis < 3; ++axis) {
    const double length = 8 + index.boundingBox().dim()[axis];
    const double height = std::max<double>(weights[axis] * length * length, largestSquaredRadius);
    if (2 * height * (double(largestSquaredRadius) + 2) * length >= 9e18) return false;
  }
  return true;
}

void sweepWithin(const LeafIndex& index, int32_t maxSquaredRadius, PowerMap& map,
                 Interrupter* interrupter) {
  if (fits64Bits(index, map.weights, maxSquaredRadius))
    sweepAll<int64_t>(index, int64_t(maxSquaredRadius) + 1, map, interrupter);
  else
    sweepAll<__int128>(index, __int128(maxSquaredRadius) + 1, map, interrupter);
}

}  // namespace

void detail::sweepPower(const LeafIndex& index, int32_t maxSquaredRadius, PowerMap& map,
                        Interrupter* interrupter) {
  if (!map.passage) return sweepWithin(index, maxSquaredRadius, map, interrupter);
  const Passage& passage = *map.passage;
  PowerMap passed;
  passed.weights = map.weights;
  passed.power = passage.spread(index, map.power, kUncovered);
  passed.site = VoxelArray<VoxelId>(passed.power.size());
  sweepWithin(passage.index(), maxSquaredRadius, passed, interrupter);
  passage.collect(index, passed.power, map.power);
  passage.collectIds(index, passed.site, map.site);
}

PowerMap powerMap(const LeafIndex& index, SquaredDistance distance, Interrupter* interrupter) {
  PowerMap map;
  map.power = std::move(distance.values);
  map.weights = distance.weights;
  map.site = VoxelArray<VoxelId>(size_t(index.voxelCount()));
  map.passage = std::move(distance.passage);
  detail::parallelFor(map.power.size(), size_t(1) << 16, interrupter,
                      [&](size_t begin, size_t end) {
                        for (size_t i = begin; i < end; ++i) map.power[i] = -map.power[i];
                      });
  detail::sweepPower(index, distance.largest, map, interrupter);
  return map;
}

}  // namespace vdb_madf
