// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/method/power_map.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "vdb_madf/base/detail/simd.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/leaves/detail/pencil.h"
#include "vdb_madf/method/detail/foreign_sites.h"
#include "vdb_madf/method/detail/metric.h"
#include "vdb_madf/method/detail/passage.h"
#include "vdb_madf/method/detail/power_passes.h"
#include "vdb_madf/method/detail/swept_leaves.h"
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

/// Power and site, of what sweeps go through. Unknown voxels are uncovered.
struct Map {
  detail::SweptValues<int32_t> power;
  detail::SweptValues<VoxelId> site;
};

constexpr int pass(int axis) {
  return 2 - axis;
}

template <int Axis, typename Key>
VDB_MADF_KERNEL void gather(const detail::SweptLeaves& leaves, const Map& map, Scratch<Key>& s) {
  int32_t power[512];
  VoxelId site[512];
  for (size_t i = 0; i < s.leaves.size(); ++i) {
    const uint32_t leaf = s.leaves[i];
    const bool fresh = Axis == 2 || !leaves.carries(pass(Axis) - 1, leaf);
    if (fresh)
      leaves.expand(leaf, map.power.object, kUncovered, power);
    else
      leaves.expand(leaf, map.power, power);
    detail::copyToSlabs<Axis>(power, kSlab, s.rows.power.data() + (i * 8 + 1) * kSlab);
    if (fresh)  // before the first pass every voxel is its own site
      for (uint32_t k = 0; k < 512; ++k) site[k] = leaves.objectLeaf(leaf) * 512 + k;
    else
      leaves.expand(leaf, map.site, site);
    detail::copyToSlabs<Axis>(site, kSlab, s.rows.site.data() + i * 8 * kSlab);
  }
}

template <int Axis, typename Key>
VDB_MADF_KERNEL void scatter(const detail::SweptLeaves& leaves, const Scratch<Key>& s, Map& map) {
  int32_t power[512];
  VoxelId site[512];
  for (size_t i = 0; i < s.leaves.size(); ++i) {
    const uint32_t leaf = s.leaves[i];
    if (!leaves.carries(pass(Axis), leaf)) continue;
    detail::copyFromSlabs<Axis>(s.rows.power.data() + (i * 8 + 1) * kSlab, kSlab, power);
    detail::copyFromSlabs<Axis>(s.rows.site.data() + i * 8 * kSlab, kSlab, site);
    leaves.pack(leaf, power, Axis == 0, map.power);
    leaves.pack(leaf, site, Axis == 0, map.site);
  }
}

/// D of all sites, from their partial power: the passes before this one have moved away from the
/// site along z, then y. `origin` is that of the pencil's first leaf.
template <int Axis, typename Key>
VDB_MADF_KERNEL void computeRadii(const LeafIndex& object, const Coord& origin,
                                  const VoxelWeights& weights, Scratch<Key>& s) {
  const Coord* origins = &object.origin(0);
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
void sweep(const detail::SweptLeaves& leaves, const detail::ForeignSites* foreign, Key multiplier,
           const VoxelWeights& weights, Map& map, Interrupter* interrupter) {
  const LeafIndex& index = leaves.index();
  const std::vector<uint32_t> starts = detail::pencilStarts(index, Axis);
  detail::PerThread<Scratch<Key>> scratches;
  detail::parallelFor(
      starts.size(), detail::kPencilGrain, interrupter, [&](size_t begin, size_t end) {
        Scratch<Key>& s = scratches.local();
        for (size_t p = begin; p < end; ++p) {
          detail::collectPencil(index, Axis, starts[p], s.leaves);
          if (!leaves.anyCarries(pass(Axis), s.leaves)) continue;
          const int length = int(s.leaves.size()) * 8;
          s.rows.resize(size_t(length));
          const Coord& origin = index.origin(starts[p]);
          detail::atBestLevel([&]() VDB_MADF_INLINE {
            gather<Axis, Key>(leaves, map, s);
            computeRadii<Axis, Key>(leaves.object(), origin, weights, s);
          });
          if (Axis == 2 && foreign) foreign->addTo(origin, length, s.rows);
          detail::lowerEnvelopes<Axis + 1>(length, multiplier, weights, s.rows);
          detail::atBestLevel([&]() VDB_MADF_INLINE { scatter<Axis, Key>(leaves, s, map); });
        }
      });
}

template <typename Key>
void sweepAll(const detail::SweptLeaves& leaves, const detail::ForeignSites* foreign,
              Key multiplier, const VoxelWeights& weights, Map& map, Interrupter* interrupter) {
  detail::WorkPart first(interrupter, 0, 33), second(interrupter, 33, 66),
      third(interrupter, 66, 100);
  sweep<2, Key>(leaves, foreign, multiplier, weights, map, &first);
  sweep<1, Key>(leaves, nullptr, multiplier, weights, map, &second);
  sweep<0, Key>(leaves, nullptr, multiplier, weights, map, &third);
}

/// Do products of a difference of keys and one of positions fit in 64 bits? `beyond`: how far rows
/// along z go on at either end.
bool fits64Bits(const LeafIndex& index, int beyond, const VoxelWeights& weights,
                int32_t largestSquaredRadius) {
  for (int axis = 0; axis < 3; ++axis) {
    const double length =
        8 + index.boundingBox().dim()[axis] + (axis == 2 ? 2 * double(beyond) : 0);
    const double height = std::max<double>(weights[axis] * length * length, largestSquaredRadius);
    if (2 * height * (double(largestSquaredRadius) + 2) * length >= 9e18) return false;
  }
  return true;
}

}  // namespace

void detail::sweepPower(const LeafIndex& index, int32_t maxSquaredRadius, PowerMap& map,
                        Interrupter* interrupter) {
  const SweptLeaves leaves(index, map.passage.get());
  Map swept{{map.power, VoxelArray<int32_t>(leaves.unknownVoxels())},
            {map.site, VoxelArray<VoxelId>(leaves.unknownVoxels())}};
  const ForeignSites* const foreign = map.foreign.get();
  if (foreign) {
    const double longest = index.boundingBox().dim().z() + 8 + double(foreign->reach());
    if (map.weights.z * longest * longest >= std::ldexp(1, 31))
      throw InvalidInput("balls reach too far from slab to slab: take lower slabs");
    maxSquaredRadius = std::max(maxSquaredRadius, foreign->largestSquaredRadius());
  }
  if (fits64Bits(leaves.index(), foreign ? foreign->reach() : 0, map.weights, maxSquaredRadius))
    sweepAll(leaves, foreign, int64_t(maxSquaredRadius) + 1, map.weights, swept, interrupter);
  else
    sweepAll(leaves, foreign, __int128(maxSquaredRadius) + 1, map.weights, swept, interrupter);
}

PowerMap powerMap(const LeafIndex& index, SquaredDistance distance, Interrupter* interrupter) {
  PowerMap map;
  map.foreign = std::move(distance.foreign);
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
