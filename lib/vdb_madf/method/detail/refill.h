// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <functional>
#include <numeric>
#include <utility>
#include <vector>

#include "vdb_madf/base/detail/parallel.h"
#include "vdb_madf/base/detail/sorted.h"
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

/// Finds the numbers that voxels of an index have in a list.
class NumberedVoxels {
 public:
  NumberedVoxels(const LeafIndex& index, const std::vector<VoxelId>& ids) : index_(index) {
    for (uint32_t i = 0; i < ids.size(); ++i) numbers_.emplace_back(ids[i], i);
    parallelSort(numbers_.begin(), numbers_.end(), std::less<>());
  }

  /// f(number) for the neighbors of a voxel that are in the list.
  template <typename F>
  void forEachBeside(VoxelId id, const F& f) const {
    forEachNeighbor(index_, id, [&](VoxelId q, int, int) {
      const auto found = std::lower_bound(numbers_.begin(), numbers_.end(), std::pair(q, 0u));
      if (found != numbers_.end() && found->first == q) f(found->second);
    });
  }

 private:
  const LeafIndex& index_;
  std::vector<std::pair<VoxelId, uint32_t>> numbers_;  // ascending
};

/// Gives labels to `count` voxels that have none, in synchronous rounds: each takes the most
/// frequent one around it, until a round changes nothing. After the first round voxels are looked
/// at beside which the round before has given a label.
/// @param around around(i): the labels around voxel i, as they are before the round
/// @param give give(i, label): voxel i has it from now on
/// @param beside beside(i, f): f(j) for the voxels of these that are neighbors of voxel i
/// @return the voxels that no round reaches, ascending. @throw Interrupted
template <typename Around, typename Give, typename Beside>
std::vector<uint32_t> refill(size_t count, const Around& around, const Give& give,
                             const Beside& beside, Interrupter* interrupter) {
  constexpr size_t kVoxelGrain = 1024;
  std::vector<char> isOpen(count, 1);
  std::vector<uint32_t> front(count), found, next;
  std::iota(front.begin(), front.end(), 0);
  while (!front.empty()) {
    found.resize(front.size());
    parallelForEach(front.size(), kVoxelGrain, interrupter,
                    [&](size_t i) { found[i] = mostFrequent(around(front[i])); });
    next.clear();
    for (size_t i = 0; i < front.size(); ++i) {
      if (found[i] == 0) continue;
      give(front[i], found[i]);
      isOpen[front[i]] = 0;
      beside(front[i], [&](uint32_t j) { next.push_back(j); });
    }
    sortUnique(next);
    next.erase(std::remove_if(next.begin(), next.end(), [&](uint32_t j) { return !isOpen[j]; }),
               next.end());
    front.swap(next);
  }
  std::vector<uint32_t> rest;
  for (uint32_t i = 0; i < count; ++i)
    if (isOpen[i]) rest.push_back(i);
  return rest;
}

}  // namespace vdb_madf::detail
