// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <array>
#include <cstdint>
#include <numeric>
#include <vector>

#include "vdb_madf/base/detail/parallel.h"
#include "vdb_madf/leaves/detail/voxels.h"
#include "vdb_madf/leaves/leaf_index.h"
#include "vdb_madf/leaves/voxel_array.h"

// How voxels without a label get one: the second part of tidy(), also where they are not in one
// index.

namespace vdb_madf::detail {

/// Labels of the neighbors of a voxel: -x, +x, -y, +y, -z, +z; 0: none.
using LabelsAround = std::array<uint32_t, 6>;

inline LabelsAround labelsAround(const LeafIndex& index, const VoxelArray<uint32_t>& labels,
                                 VoxelId id) {
  LabelsAround around{};
  forEachNeighbor(index, id, [&](VoxelId q, int axis, int step) {
    if (isObject(index, q)) around[size_t(2 * axis + (step > 0))] = labels[index.rank(q)];
  });
  return around;
}

/// The label that most neighbors have, of equally frequent ones the smallest; 0 if none has one.
uint32_t mostFrequent(const LabelsAround& around);

/// Gives labels to `count` voxels that have none, in synchronous rounds: each takes the most
/// frequent one around it, until a round changes nothing.
/// @param around around(i): the labels around voxel i, as they are before the round
/// @param give give(i, label): voxel i has it from now on
/// @return the voxels that no round reaches, ascending. @throw Interrupted
template <typename Around, typename Give>
std::vector<uint32_t> refill(size_t count, const Around& around, const Give& give,
                             Interrupter* interrupter) {
  constexpr size_t kVoxelGrain = 1024;
  std::vector<uint32_t> rest(count), found;
  std::iota(rest.begin(), rest.end(), 0);
  for (bool changed = true; changed && !rest.empty();) {
    found.resize(rest.size());
    parallelFor(rest.size(), kVoxelGrain, interrupter, [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i) found[i] = mostFrequent(around(rest[i]));
    });
    size_t left = 0;
    for (size_t i = 0; i < rest.size(); ++i) {
      if (found[i] == 0)
        rest[left++] = rest[i];
      else
        give(rest[i], found[i]);
    }
    changed = left < rest.size();
    rest.resize(left);
  }
  return rest;
}

}  // namespace vdb_madf::detail
