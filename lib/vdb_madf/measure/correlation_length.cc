// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/measure/correlation_length.h"

#include "vdb_madf/measure/detail/correlation_decay.h"
#include "vdb_madf/measure/detail/voxel_pairs.h"

namespace vdb_madf {

std::array<std::optional<double>, 3> correlationLengths(const LeafIndex& index,
                                                        const Domain& domain,
                                                        Interrupter* interrupter) {
  std::array<std::optional<double>, 3> lengths;
  if (index.voxelCount() == 0) return lengths;
  for (int axis = 0; axis < 3; ++axis) {
    detail::CorrelationDecay decay(index.voxelCount(), domain, axis);
    if (decay.isDone()) continue;
    detail::VoxelPairs pairs(index, axis);
    while (!decay.isDone()) decay.add(pairs.count(decay.lag(), interrupter), interrupter);
    lengths[size_t(axis)] = decay.length();
  }
  return lengths;
}

}  // namespace vdb_madf
