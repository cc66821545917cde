// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/method/detail/envelope_sweeps.h"

#include <algorithm>

#include "vdb_madf/base/detail/simd.h"
#include "vdb_madf/leaves/detail/pencil.h"
#include "vdb_madf/method/detail/metric.h"
#include "vdb_madf/method/kernels/lower_envelope.h"
#include "vdb_madf/method/power_map.h"

namespace vdb_madf::detail {

namespace {

constexpr size_t kSlab = kEnvelopeSlab;
static_assert(kUncovered == kNotNegative);

/// What one thread works with.
template <typename Key>
struct EnvelopeScratch {
  std::vector<uint32_t> leaves;  // of the pencil
  EnvelopeRows<Key> rows;
};

template <int Axis, typename Key>
VDB_MADF_KERNEL void gather(const SweptLeaves& leaves, const PowerValues& values,
                            EnvelopeScratch<Key>& s) {
  int32_t power[512];
  VoxelId site[512];
  for (size_t i = 0; i < s.leaves.size(); ++i) {
    const uint32_t leaf = s.leaves[i];
    const bool fresh = Axis == 2 || !leaves.carries(powerPass(Axis) - 1, leaf);
    if (fresh)
      leaves.expand(leaf, values.power.object, kUncovered, power);
    else
      leaves.expand(leaf, values.power, power);
    copyToSlabs<Axis>(power, kSlab, s.rows.power.data() + (i * 8 + 1) * kSlab);
    if (fresh)  // before the first pass every voxel is its own site
      for (uint32_t k = 0; k < 512; ++k) site[k] = leaves.objectLeaf(leaf) * 512 + k;
    else
      leaves.expand(leaf, values.site, site);
    copyToSlabs<Axis>(site, kSlab, s.rows.site.data() + i * 8 * kSlab);
  }
}

template <int Axis, typename Key>
VDB_MADF_KERNEL void scatter(const SweptLeaves& leaves, const EnvelopeScratch<Key>& s,
                             PowerValues& values) {
  int32_t power[512];
  VoxelId site[512];
  for (size_t i = 0; i < s.leaves.size(); ++i) {
    const uint32_t leaf = s.leaves[i];
    if (!leaves.carries(powerPass(Axis), leaf)) continue;
    copyFromSlabs<Axis>(s.rows.power.data() + (i * 8 + 1) * kSlab, kSlab, power);
    copyFromSlabs<Axis>(s.rows.site.data() + i * 8 * kSlab, kSlab, site);
    leaves.pack(leaf, power, Axis == 0, values.power);
    leaves.pack(leaf, site, Axis == 0, values.site);
  }
}

/// D of all sites, from their partial power: the passes before this one have moved away from the
/// site along z, then y. `origin` is that of the pencil's first leaf.
template <int Axis, typename Key>
VDB_MADF_KERNEL void computeRadii(const LeafIndex& object, const Coord& origin,
                                  const VoxelWeights& weights, EnvelopeScratch<Key>& s) {
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
        away = squaredAlong(dz, weights.z) + (Axis == 0 ? squaredAlong(dy, weights.y) : 0);
      }
      radius2[row] = away - power[row];
    }
  }
}

template <int Axis, typename Key>
void sweep(const SweptLeaves& leaves, const ForeignSites* foreign, Key multiplier,
           const VoxelWeights& weights, PowerValues& values, Interrupter* interrupter) {
  const LeafIndex& index = leaves.index();
  const std::vector<uint32_t> starts = pencilStarts(index, Axis);
  PerThread<EnvelopeScratch<Key>> scratches;
  parallelFor(starts.size(), kPencilGrain, interrupter, [&](size_t begin, size_t end) {
    EnvelopeScratch<Key>& s = scratches.local();
    for (size_t p = begin; p < end; ++p) {
      collectPencil(index, Axis, starts[p], s.leaves);
      if (!leaves.anyCarries(powerPass(Axis), s.leaves)) continue;
      const int length = int(s.leaves.size()) * 8;
      s.rows.resize(size_t(length));
      const Coord& origin = index.origin(starts[p]);
      atBestLevel([&]() VDB_MADF_INLINE {
        gather<Axis, Key>(leaves, values, s);
        computeRadii<Axis, Key>(leaves.object(), origin, weights, s);
      });
      if (Axis == 2 && foreign) foreign->addTo(origin, length, s.rows);
      lowerEnvelopes(length, multiplier, weights[Axis], s.rows);
      atBestLevel([&]() VDB_MADF_INLINE { scatter<Axis, Key>(leaves, s, values); });
    }
  });
}

template <typename Key>
void sweepAll(const SweptLeaves& leaves, const ForeignSites* foreign, Key multiplier,
              const VoxelWeights& weights, PowerValues& values, Interrupter* interrupter) {
  WorkPart first(interrupter, 0, 33), second(interrupter, 33, 66), third(interrupter, 66, 100);
  sweep<2, Key>(leaves, foreign, multiplier, weights, values, &first);
  sweep<1, Key>(leaves, nullptr, multiplier, weights, values, &second);
  sweep<0, Key>(leaves, nullptr, multiplier, weights, values, &third);
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

void sweepEnvelopes(const SweptLeaves& leaves, const ForeignSites* foreign,
                    int32_t maxSquaredRadius, const VoxelWeights& weights, PowerValues& values,
                    Interrupter* interrupter) {
  if (fits64Bits(leaves.index(), foreign ? foreign->reach() : 0, weights, maxSquaredRadius))
    sweepAll(leaves, foreign, int64_t(maxSquaredRadius) + 1, weights, values, interrupter);
  else
    sweepAll(leaves, foreign, __int128(maxSquaredRadius) + 1, weights, values, interrupter);
}

}  // namespace vdb_madf::detail
