// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/method/power_map.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "vdb_madf/base/detail/parallel.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/method/detail/envelope_sweeps.h"
#include "vdb_madf/method/detail/power_passes.h"
#include "vdb_madf/method/detail/window_sweeps.h"
#include "vdb_madf/method/kernels/power_windows.h"

namespace vdb_madf {

static_assert(kUncovered == detail::kNotNegative);

void detail::sweepPower(const LeafIndex& index, int32_t maxSquaredRadius, PowerMap& map,
                        Interrupter* interrupter) {
  const SweptLeaves leaves(index, map.passage.get());
  PowerValues values{{map.power, VoxelArray<int32_t>(leaves.unknownVoxels())},
                     {map.site, VoxelArray<VoxelId>(leaves.unknownVoxels())}};
  const ForeignSites* const foreign = map.foreign.get();
  if (foreign) {
    const double longest = index.boundingBox().dim().z() + 8 + double(foreign->reach());
    if (map.weights.z * longest * longest >= std::ldexp(1, 31))
      throw InvalidInput("balls reach too far from slab to slab: take lower slabs");
    maxSquaredRadius = std::max(maxSquaredRadius, foreign->largestSquaredRadius());
  }
  const auto sweep = maxSquaredRadius <= kLargestKeyedSquaredRadius ? sweepWindows : sweepEnvelopes;
  sweep(leaves, foreign, maxSquaredRadius, map.weights, values, interrupter);
}

PowerMap powerMap(const LeafIndex& index, SquaredDistance distance, Interrupter* interrupter) {
  PowerMap map;
  map.foreign = std::move(distance.foreign);
  map.power = std::move(distance.values);
  map.weights = distance.weights;
  map.site = VoxelArray<VoxelId>(size_t(index.voxelCount()));
  map.passage = std::move(distance.passage);
  detail::parallelForEach(map.power.size(), size_t(1) << 16, interrupter,
                          [&](size_t i) { map.power[i] = -map.power[i]; });
  detail::sweepPower(index, distance.largest, map, interrupter);
  return map;
}

}  // namespace vdb_madf
